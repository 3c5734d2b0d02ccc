#include "format/system/sync_folder.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

/// Ignores EINVAL, the result of file systems that cannot sync folders. Sets errno on failure.
bool sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno == EACCES;  // a folder may be writable and not readable
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return synced;
}

}  // namespace

Result<void> sync_folder_of(const std::filesystem::path& target, const std::filesystem::path& path) {
  if (sync_folder(target.parent_path())) return {};
  return fail(ErrorCode::kFailed, "{}: is written whole, but its folder cannot be synced: {}", path.string(),
              std::strerror(errno));
}

}  // namespace splatlas
