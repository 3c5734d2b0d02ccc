#include "format/system/temporary_entry.h"

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <memory>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <ftw.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = ".splatlas-";

bool is_same(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// True if the open entry is still the one at `path`.
bool has_name(int descriptor, const fs::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(descriptor, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && is_same(open, named);
}

/// Waits for processes in remove_if_unlocked(). On file systems without locks these cannot lock it either, so
/// that it is never stale.
void lock(int descriptor) {
  while (::flock(descriptor, LOCK_EX) != 0 && errno == EINTR) {
  }
}

/// The process id in the name of a temporary; nullopt for other names.
std::optional<pid_t> writer_of(std::string_view name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const char* const end = name.data() + name.size();
  pid_t process = 0;
  const auto first = std::from_chars(name.data() + kPrefix.size(), end, process);
  if (first.ec != std::errc() || process <= 0 || first.ptr == end || *first.ptr != '-') return std::nullopt;
  unsigned number = 0;
  const auto second = std::from_chars(first.ptr + 1, end, number);
  if (second.ec != std::errc() || (second.ptr != end && *second.ptr != '.')) return std::nullopt;
  return process;
}

/// False for this process, too: it locks its entries, so that an unlocked one belongs to an earlier process.
bool may_be_alive(pid_t process) {
  return process != ::getpid() && (::kill(process, 0) == 0 || errno != ESRCH);
}

// Not std::filesystem: directory iterators of libstdc++ end the program when out of memory.

/// Removes a file, or a folder with its content. Ignores errors; later writers try again.
void remove_whole(const fs::path& path) {
  constexpr int kOpenFolders = 8;
  const auto remove_one = [](const char* name, const struct stat*, int, FTW*) {
    ::remove(name);
    return 0;
  };
  if (::unlink(path.c_str()) != 0) ::nftw(path.c_str(), remove_one, kOpenFolders, FTW_DEPTH | FTW_PHYS);
}

void remove_if_unlocked(const fs::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || status.st_uid != ::geteuid()) return;
  if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return;
  const int entry = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (entry < 0) return;
  if (::flock(entry, LOCK_EX | LOCK_NB) == 0 && has_name(entry, path)) remove_whole(path);
  ::close(entry);
}

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

TemporaryEntry::~TemporaryEntry() {
  const DeferInterrupts until_removed;
  if (exists_) remove_whole(path_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool TemporaryEntry::create(Kind kind) {
  if (kind == Kind::kFolder) {
    if (::mkdir(path_.c_str(), 0777) != 0) return false;
    exists_ = true;
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    return descriptor_ >= 0;
  }
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) return false;
  exists_ = true;
  remove_on_interrupt_.emplace(path_);
  return true;
}

bool TemporaryEntry::make(const fs::path& folder, Kind kind, std::string_view ending) {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 100;
  const DeferInterrupts until_named;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    path_ = folder / fmt::format("{}{}-{}{}", kPrefix, ::getpid(), counter++, ending);
    if (create(kind)) {
      lock(descriptor_);
      if (has_name(descriptor_, path_)) return true;
      // Another process removed it as stale before it was locked.
      exists_ = false;
      remove_on_interrupt_.reset();
      ::close(std::exchange(descriptor_, -1));
      errno = EEXIST;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

bool TemporaryEntry::follow_name() {
  if (has_name(descriptor_, path_)) return true;
  const int other = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (other < 0) return false;
  ::close(std::exchange(descriptor_, other));
  lock(descriptor_);
  return true;
}

bool TemporaryEntry::rename_to(const fs::path& target) {
  const DeferInterrupts until_renamed;
  if (::rename(path_.c_str(), target.c_str()) != 0) return false;
  exists_ = false;
  remove_on_interrupt_.reset();
  return true;
}

void remove_stale_temporaries(const fs::path& folder) {
  DIR* const open = ::opendir(folder.empty() ? "." : folder.c_str());
  if (open == nullptr) return;
  const std::unique_ptr<DIR, int (*)(DIR*)> close_at_end(open, ::closedir);
  while (const dirent* entry = ::readdir(open)) {
    const std::optional<pid_t> writer = writer_of(entry->d_name);
    if (writer && !may_be_alive(*writer)) remove_if_unlocked(folder / entry->d_name);
  }
}

Result<void> sync_folder_of(const std::filesystem::path& target, const std::filesystem::path& path) {
  if (sync_folder(target.parent_path())) return {};
  return fail(ErrorCode::kFailed, "{}: is written whole, but its folder cannot be synced: {}", path.string(),
              std::strerror(errno));
}

}  // namespace splatlas
