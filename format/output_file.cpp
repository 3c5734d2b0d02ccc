#include "format/output_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/interrupts.h"
#include "format/output_path.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 26;

/// Makes the rename last. File systems that cannot sync a folder say EINVAL; the file itself is complete by
/// now.
bool sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno == EACCES;  // a folder may be writable and not readable
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return synced;
}

}  // namespace

/// Functions that return bool leave the reason in errno.
struct OutputFile::Impl {
  explicit Impl(fs::path output) : path(std::move(output)), target(resolve_output(path)) {}
  ~Impl() {
    const DeferInterrupts until_removed;
    if (descriptor >= 0) ::close(descriptor);
    if (remove) ::unlink(temporary.c_str());
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] tl::unexpected<Error> cannot_write(const std::string& reason) const {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}", path.string(), reason));
  }
  /// Takes a name that nobody has, beside the target: a rename must not cross file systems.
  [[nodiscard]] bool open(std::string_view ending);
  /// Everything of it is on the disk, under its temporary name.
  [[nodiscard]] bool complete();
  [[nodiscard]] bool rename();

  fs::path path, target, temporary;
  std::optional<mode_t> old_mode;
  int descriptor = -1;
  std::optional<RemoveOnInterrupt> remove;  // while there is a temporary file
};

bool OutputFile::Impl::open(std::string_view ending) {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 100;
  const DeferInterrupts until_named;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    temporary = target.parent_path() / fmt::format(".splatlas-{}-{}{}", ::getpid(), counter++, ending);
    descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor >= 0) {
      remove.emplace(temporary);
      return true;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

bool OutputFile::Impl::complete() {
  if (::close(std::exchange(descriptor, -1)) != 0) return false;
  // By its name: whoever wrote to a path may have put another file there.
  descriptor = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  return descriptor >= 0 && (!old_mode || ::fchmod(descriptor, *old_mode) == 0) && ::fsync(descriptor) == 0;
}

bool OutputFile::Impl::rename() {
  const DeferInterrupts until_renamed;
  if (::rename(temporary.c_str(), target.c_str()) != 0) return false;
  remove.reset();
  return true;
}

OutputFile::OutputFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

Result<OutputFile> OutputFile::create(const fs::path& target, std::string_view ending) {
  auto impl = std::make_unique<Impl>(target);
  struct stat old {};
  if (::stat(target.c_str(), &old) == 0) {
    if (!S_ISREG(old.st_mode)) {
      return impl->cannot_write(S_ISDIR(old.st_mode) ? "it is a folder" : "it is not a regular file");
    }
    constexpr mode_t kPermissions = 07777;
    impl->old_mode = old.st_mode & kPermissions;
  } else if (errno != ENOENT) {
    return impl->cannot_write(std::strerror(errno));
  }
  if (target.filename().empty()) return impl->cannot_write("it names no file");
  if (!impl->open(ending)) return impl->cannot_write(std::strerror(errno));
  return OutputFile(std::move(impl));
}

const fs::path& OutputFile::temporary() const {
  return impl_->temporary;
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(impl_->descriptor, bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return impl_->cannot_write(std::strerror(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> OutputFile::commit() {
  return commit_files({this, 1});
}

Result<void> commit_files(std::span<OutputFile> files) {
  for (const OutputFile& file : files) {
    if (!file.impl_->complete()) return file.impl_->cannot_write(std::strerror(errno));
  }
  const DeferInterrupts all_or_none;
  for (const OutputFile& file : files) {
    if (!file.impl_->rename() || !sync_folder(file.impl_->target.parent_path())) {
      return file.impl_->cannot_write(std::strerror(errno));
    }
  }
  return {};
}

Result<void> write_file(const fs::path& path, std::span<const std::byte> bytes) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes));
  return file.commit();
}

}  // namespace splatlas
