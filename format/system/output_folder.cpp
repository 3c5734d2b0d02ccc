#include "format/system/output_folder.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "format/system/check_writable.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"
#include "format/system/sync_folder.h"
#include "format/system/temporary_entry.h"

namespace splatlas {

namespace fs = std::filesystem;

struct OutputFolder::Impl {
  explicit Impl(fs::path output) : path(std::move(output)), target(resolve_output(without_end_slash(path))) {}

  [[nodiscard]] tl::unexpected<Error> cannot_write(const std::string& reason) const {
    return fail(ErrorCode::kFailed, "{}: cannot be written: {}", path.string(), reason);
  }

  fs::path path, target;
  TemporaryEntry temporary;
};

OutputFolder::OutputFolder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OutputFolder::~OutputFolder() = default;
OutputFolder::OutputFolder(OutputFolder&&) noexcept = default;
OutputFolder& OutputFolder::operator=(OutputFolder&&) noexcept = default;

Result<OutputFolder> OutputFolder::create(const fs::path& target) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_folder(target));
  auto impl = std::make_unique<Impl>(target);
  const fs::path parent = impl->target.parent_path();
  remove_stale_temporaries(parent);
  if (!impl->temporary.make(parent, TemporaryEntry::Kind::kFolder))
    return impl->cannot_write(std::strerror(errno));
  return OutputFolder(std::move(impl));
}

const fs::path& OutputFolder::temporary() const {
  return impl_->temporary.path();
}

Result<void> OutputFolder::commit() {
  if (!impl_->temporary.rename_to(impl_->target)) return impl_->cannot_write(std::strerror(errno));
  return sync_folder_of(impl_->target, impl_->path);
}

}  // namespace splatlas
