#include "format/output_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace splatlas {

namespace {

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 26;

tl::unexpected<Error> cannot_write(const std::filesystem::path& path, const std::string& reason) {
  return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}", path.string(), reason));
}

/// A new file of a name that nobody has, removed again unless it is kept.
class TemporaryFile {
 public:
  /// Beside `path`: a rename must not cross file systems. Check is_open().
  explicit TemporaryFile(const std::filesystem::path& path) {
    static std::atomic<unsigned> counter{0};
    constexpr int kAttempts = 100;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      path_ = path.parent_path() / fmt::format(".splatlas-{}-{}.tmp", ::getpid(), counter++);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
      remove_ = descriptor_ >= 0;
      if (descriptor_ >= 0 || errno != EEXIST) return;
    }
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (remove_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// errno tells why not. All of the following likewise return whether they succeeded.
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }
  [[nodiscard]] bool set_mode(mode_t mode) const { return ::fchmod(descriptor_, mode) == 0; }
  [[nodiscard]] bool sync() const { return ::fsync(descriptor_) == 0; }
  [[nodiscard]] bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }
  [[nodiscard]] bool rename_to(const std::filesystem::path& path) {
    if (::rename(path_.c_str(), path.c_str()) != 0) return false;
    remove_ = false;
    return true;
  }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool remove_ = false;
};

/// Makes the rename last. File systems that cannot sync a folder say EINVAL; the file itself is complete by
/// now.
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

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  struct stat old {};
  const bool replaces = ::stat(path.c_str(), &old) == 0;
  if (replaces && !S_ISREG(old.st_mode)) {
    return cannot_write(path, S_ISDIR(old.st_mode) ? "it is a folder" : "it is not a regular file");
  }
  std::error_code unresolved;
  std::filesystem::path target = replaces ? std::filesystem::canonical(path, unresolved) : path;
  if (unresolved) return cannot_write(path, unresolved.message());
  if (target.filename().empty()) return cannot_write(path, "it names no file");

  TemporaryFile temporary(target);
  constexpr mode_t kPermissions = 07777;
  if (!temporary.is_open() || !temporary.write(bytes) ||
      (replaces && !temporary.set_mode(old.st_mode & kPermissions)) || !temporary.sync() ||
      !temporary.close() || !temporary.rename_to(target) || !sync_folder(target.parent_path())) {
    return cannot_write(path, std::strerror(errno));
  }
  return {};
}

}  // namespace splatlas
