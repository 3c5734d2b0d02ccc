#include "format/io/output_folder.h"

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/io/check_writable.h"
#include "format/io/output_path.h"
#include "format/io/staged_file.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Maximum number of unnamed files: with two descriptors each, a quarter of the usual limit.
constexpr std::size_t kMaxUnnamed = 128;
constexpr mode_t kPrivateFolder = 0700, kPublicFolder = 0777;

}  // namespace

struct OutputFolder::Impl {
  ~Impl();
  /// Creates the folder with the random name.
  [[nodiscard]] Result<void> create_folder();
  /// Moves the complete files into that folder.
  [[nodiscard]] Result<void> name_files();
  [[nodiscard]] tl::unexpected<Error> error() const { return cannot_write(path, std::strerror(errno)); }

  fs::path path, target;           // as given, and with links resolved
  std::optional<struct stat> old;  // of the empty folder to be replaced
  FolderHandle parent, folder;
  bool has_unnamed_files = true;     // they are created in `parent`, else in `folder`
  std::string random_name;           // of `folder`; empty before it exists and after the rename
  std::vector<OutputFile> complete;  // files to be named
  std::vector<std::string> members;  // names of files in `folder`
};

OutputFolder::Impl::~Impl() {
  complete.clear();  // they may have random names in the folder
  if (random_name.empty()) return;
  for (const std::string& member : members) ::unlinkat(folder.descriptor(), member.c_str(), 0);
  ::unlinkat(parent.descriptor(), random_name.c_str(), AT_REMOVEDIR);
}

Result<void> OutputFolder::Impl::create_folder() {
  const std::string name = splatlas::random_name();
  if (!folder.create(parent, name, old ? kPrivateFolder : kPublicFolder)) return error();
  random_name = name;
  return {};
}

Result<void> OutputFolder::Impl::name_files() {
  if (random_name.empty()) SPLATLAS_RETURN_IF_ERROR(create_folder());
  for (OutputFile& file : complete) {
    const std::string name = file.impl_->target.filename();
    members.push_back(name);
    if (!file.impl_->staged.publish(folder, name)) {
      members.pop_back();
      return cannot_write(file.impl_->path, std::strerror(errno));
    }
  }
  complete.clear();
  return {};
}

OutputFolder::OutputFolder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OutputFolder::~OutputFolder() = default;
OutputFolder::OutputFolder(OutputFolder&&) noexcept = default;
OutputFolder& OutputFolder::operator=(OutputFolder&&) noexcept = default;

Result<OutputFolder> OutputFolder::create(const fs::path& target) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_folder(target));
  auto impl = std::make_unique<Impl>();
  impl->path = target;
  impl->target = resolve_output(without_end_slash(target));
  struct stat old {};
  if (::stat(impl->target.c_str(), &old) == 0) impl->old = old;
  if (!impl->parent.open(impl->target.parent_path())) return impl->error();
  impl->has_unnamed_files = impl->parent.supports_unnamed_files();
  return OutputFolder(std::move(impl));
}

const fs::path& OutputFolder::path() const {
  return impl_->path;
}

Result<OutputFile> OutputFolder::create_file(const std::string& name) {
  auto file = std::make_unique<UnfinishedFile>();
  file->path = impl_->path / name;
  file->target = impl_->target / name;
  if (!impl_->has_unnamed_files && impl_->random_name.empty())
    SPLATLAS_RETURN_IF_ERROR(impl_->create_folder());
  SPLATLAS_RETURN_IF_ERROR(
      file->create((impl_->has_unnamed_files ? impl_->parent : impl_->folder).duplicate()));
  return OutputFile(std::move(file));
}

Result<void> OutputFolder::add(OutputFile file) {
  SPLATLAS_RETURN_IF_ERROR(file.impl_->complete());
  impl_->complete.push_back(std::move(file));
  return impl_->complete.size() < kMaxUnnamed ? Result<void>{} : impl_->name_files();
}

Result<void> OutputFolder::commit() {
  SPLATLAS_RETURN_IF_ERROR(impl_->name_files());
  if (impl_->old && !keep_owner_and_mode(impl_->folder.descriptor(), *impl_->old)) return impl_->error();
  if (!impl_->folder.sync()) return impl_->error();
  const std::string name = impl_->target.filename();
  const int parent = impl_->parent.descriptor();
  if (::renameat(parent, impl_->random_name.c_str(), parent, name.c_str()) != 0) return impl_->error();
  impl_->random_name.clear();
  if (impl_->parent.sync()) return {};
  return cannot_sync_folder(impl_->path, std::strerror(errno));
}

}  // namespace splatlas
