#include "preprocess/export/temporary_output.h"

#include <cerrno>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "format/ascii_text.h"
#include "format/interrupts.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// ".nii.gz" is one ending.
std::string ending_of(const fs::path& path) {
  const std::string last = path.extension().string();
  return to_lower(last) == ".gz" ? path.stem().extension().string() + last : last;
}

bool sync_file(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = ::fsync(descriptor) == 0;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return synced;
}

}  // namespace

Result<void> write_by_way_of_temporary(const fs::path& path,
                                       const std::function<Result<void>(const fs::path&)>& write) {
  const auto cannot_write = [&](const std::string& reason) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}", path.string(), reason));
  };
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return cannot_write("it is not a regular file");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    return cannot_write(fmt::format("there is no folder {}", folder.string()));

  // Reserve the name, so that a folder that cannot be written to says so itself.
  const fs::path temporary = folder / fmt::format(".splatlas-{}{}", ::getpid(), ending_of(path));
  const int descriptor =
      ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return cannot_write(std::strerror(errno));
  ::close(descriptor);

  const RemoveOnInterrupt remove(temporary);
  Result<void> written = write(temporary);
  if (written && !sync_file(temporary)) written = cannot_write(std::strerror(errno));
  if (written && ::rename(temporary.c_str(), path.c_str()) != 0) written = cannot_write(std::strerror(errno));
  if (!written) ::unlink(temporary.c_str());
  return written;
}

}  // namespace splatlas
