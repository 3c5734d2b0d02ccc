#include "format/io/staged_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
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

constexpr int kFolderFlags = O_PATH | O_DIRECTORY | O_CLOEXEC;
/// Attempts to find an unused random name: one is enough unless the random source fails.
constexpr int kAttempts = 10;

/// True for errors of file systems that support no unnamed files.
bool lacks_unnamed_files(int error) {
  return error == EOPNOTSUPP || error == EISDIR || error == EINVAL || error == ENOENT || error == ENOSYS;
}

std::string path_of_descriptor(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

/// A new file without a name, that linkat() can name; -1, with errno set, on failure.
int open_unnamed_file(int folder, mode_t mode) {
  const int file = ::openat(folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
  if (file < 0) return -1;
  // linkat() needs this path; /proc may be missing.
  if (::faccessat(AT_FDCWD, path_of_descriptor(file).c_str(), F_OK, AT_EACCESS) == 0) return file;
  ::close(file);
  errno = EOPNOTSUPP;
  return -1;
}

/// Closes a descriptor and keeps errno.
void close_quietly(int descriptor) {
  const int reason = errno;
  if (descriptor >= 0) ::close(descriptor);
  errno = reason;
}

}  // namespace

FolderHandle::~FolderHandle() {
  close_quietly(descriptor_);
}

FolderHandle::FolderHandle(FolderHandle&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

FolderHandle& FolderHandle::operator=(FolderHandle&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

bool FolderHandle::open(const fs::path& folder) {
  descriptor_ = ::open(folder.empty() ? "." : folder.c_str(), kFolderFlags);
  return descriptor_ >= 0;
}

bool FolderHandle::create(const FolderHandle& parent, const std::string& name, mode_t mode) {
  if (::mkdirat(parent.descriptor(), name.c_str(), mode) != 0) return false;
  descriptor_ = ::openat(parent.descriptor(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor_ >= 0) return true;
  const int reason = errno;
  ::unlinkat(parent.descriptor(), name.c_str(), AT_REMOVEDIR);
  errno = reason;
  return false;
}

FolderHandle FolderHandle::duplicate() const {
  FolderHandle other;
  other.descriptor_ = ::openat(descriptor_, ".", kFolderFlags);
  return other;
}

bool FolderHandle::supports_unnamed_files() const {
  const int file = open_unnamed_file(descriptor_, 0600);
  close_quietly(file);
  return file >= 0;
}

bool FolderHandle::sync() const {
  const int readable = ::openat(descriptor_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (readable < 0) return errno == EACCES;  // a folder may be writable and not readable
  const bool synced = ::fsync(readable) == 0 || errno == EINVAL || errno == ENOTSUP;
  close_quietly(readable);
  return synced;
}

std::string random_name() {
  std::array<std::uint64_t, 2> bits{};
  std::size_t got = 0;
  while (got < sizeof bits) {
    const ssize_t n = ::getrandom(reinterpret_cast<std::byte*>(bits.data()) + got, sizeof bits - got, 0);
    if (n < 0 && errno != EINTR) break;  // never on Linux 3.17 or newer; O_EXCL still protects other files
    got += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  return fmt::format(".splatlas-{:016x}{:016x}", bits[0], bits[1]);
}

StagedFile::~StagedFile() {
  const DeferInterrupts until_removed;
  remove_name();
  close_quietly(descriptor_);
}

bool StagedFile::create(FolderHandle folder, mode_t mode) {
  folder_ = std::move(folder);
  descriptor_ = open_unnamed_file(folder_.descriptor(), mode);
  return descriptor_ >= 0 || (lacks_unnamed_files(errno) && create_named(mode));
}

bool StagedFile::create_named(mode_t mode) {
  const DeferInterrupts until_named;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string name = random_name();
    descriptor_ = ::openat(folder_.descriptor(), name.c_str(),
                           O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
    if (descriptor_ < 0 && errno == EEXIST) continue;
    if (descriptor_ < 0) return false;
    remove_on_interrupt_.emplace(folder_.descriptor(), name, descriptor_);
    random_name_ = std::move(name);
    return true;
  }
  return false;
}

bool StagedFile::publish(const FolderHandle& folder, const std::string& name) {
  const DeferInterrupts until_renamed;
  if (random_name_.empty()) {
    const auto link = [&](const FolderHandle& to, const std::string& as) {
      return ::linkat(AT_FDCWD, path_of_descriptor(descriptor_).c_str(), to.descriptor(), as.c_str(),
                      AT_SYMLINK_FOLLOW) == 0;
    };
    if (link(folder, name)) return true;
    if (errno != EEXIST) return false;
    // No system call replaces a file by an unnamed one.
    std::string temporary = random_name();
    if (!link(folder_, temporary)) return false;
    random_name_ = std::move(temporary);
  }
  if (::renameat(folder_.descriptor(), random_name_.c_str(), folder.descriptor(), name.c_str()) != 0) {
    const int reason = errno;
    remove_name();
    errno = reason;
    return false;
  }
  random_name_.clear();
  remove_on_interrupt_.reset();
  return true;
}

void StagedFile::remove_name() {
  if (!random_name_.empty()) remove_file_named(folder_.descriptor(), random_name_.c_str(), descriptor_);
  random_name_.clear();
  remove_on_interrupt_.reset();
}

fs::path StagedFile::path() const {
  return path_of_descriptor(descriptor_);
}

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
