#include "format/system/output_folder.h"

#include <cerrno>
#include <cstring>

#include "format/system/check_writable.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"

namespace splatlas {

namespace fs = std::filesystem;

Result<OutputFolder> OutputFolder::create(const fs::path& target) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_folder(target));
  OutputFolder folder;
  folder.path_ = target;
  folder.target_ = resolve_output(without_end_slash(target));
  const fs::path parent = folder.target_.parent_path();
  remove_stale_temporaries(parent);
  if (!folder.temporary_->make(parent, TemporaryEntry::Kind::kFolder))
    return cannot_write(target, std::strerror(errno));
  return folder;
}

Result<void> OutputFolder::commit() {
  if (!temporary_->rename_to(target_)) return cannot_write(path_, std::strerror(errno));
  return sync_folder_of(target_, path_);
}

}  // namespace splatlas
