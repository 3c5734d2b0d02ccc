#include "format/io/unfinished_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "format/io/output_path.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBackBytes = std::size_t{1} << 20;
constexpr mode_t kPermissions = 0777;  // not setuid, setgid and sticky
constexpr mode_t kPrivate = 0600, kPublic = 0666;

/// Verifies that the file contains the bytes of write().
Result<void> read_back(int descriptor, std::uint64_t bytes, const RunningChecksum& written,
                       const fs::path& path) {
  // Drop cached pages, so that reads come from the disk if possible.
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  RunningChecksum read;
  std::vector<std::byte> piece(std::min<std::uint64_t>(kReadBackBytes, bytes + 1));
  for (std::uint64_t offset = 0;;) {
    const ssize_t got = ::pread(descriptor, piece.data(), piece.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannot_write(path, fmt::format("reading it back: {}", std::strerror(errno)));
    if (got == 0 && offset == bytes && read.value() == written.value()) return {};
    if (got == 0) return cannot_write(path, "other bytes come back from the disk than were written");
    offset += static_cast<std::uint64_t>(got);
    read.add(std::span(piece).first(static_cast<std::size_t>(got)));
  }
}

}  // namespace

bool keep_owner_and_mode(int descriptor, const struct stat& old) {
  struct stat now {};
  if (::fstat(descriptor, &now) != 0) return false;
  mode_t mode = old.st_mode & kPermissions;
  const bool other_owner = now.st_uid != old.st_uid || now.st_gid != old.st_gid;
  if (other_owner && ::fchown(descriptor, old.st_uid, old.st_gid) != 0 && now.st_gid != old.st_gid &&
      ::fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) != 0) {
    mode = (mode & ~S_IRWXG) | (mode & S_IRWXO) << 3;
  }
  return ::fchmod(descriptor, mode) == 0;
}

Result<void> UnfinishedFile::create(FolderHandle folder) {
  if (folder.descriptor() >= 0 && staged.create(std::move(folder), old ? kPrivate : kPublic)) return {};
  return cannot_write(path, std::strerror(errno));
}

Result<void> UnfinishedFile::complete() const {
  const int file = staged.descriptor();
  if ((old && !keep_owner_and_mode(file, *old)) || ::fsync(file) != 0)
    return cannot_write(path, std::strerror(errno));
  return written ? read_back(file, written_bytes, *written, path) : Result<void>{};
}

}  // namespace splatlas
