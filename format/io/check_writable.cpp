#include "format/io/check_writable.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "format/io/output_path.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> check_folder_of(const fs::path& path) {
  const fs::path target = resolve_output(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return cannot_write(path, fmt::format("there is no folder {}", folder.string()));
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    return cannot_write(path, std::strerror(errno));
  return {};
}

}  // namespace

fs::path without_end_slash(const fs::path& folder) {
  return folder.has_filename() ? folder : folder.parent_path();
}

Result<void> check_writable_file(const fs::path& path) {
  if (path.empty()) return fail(ErrorCode::kUsage, "\"\": the output must have a name");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (path.filename().empty() || fs::is_directory(status)) return cannot_write(path, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    return cannot_write(path, "it is not a regular file");
  if (fs::exists(status) && ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)
    return cannot_write(path, std::strerror(errno));
  return check_folder_of(path);
}

Result<void> check_writable_folder(const fs::path& path) {
  const fs::path target = without_end_slash(path);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (fs::exists(status) && !(fs::is_directory(status) && fs::is_empty(target, error)))
    return cannot_write(path, "it exists and is not an empty folder; name a new one");
  return check_folder_of(target);
}

}  // namespace splatlas
