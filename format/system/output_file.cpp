#include "format/system/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/system/interrupts.h"
#include "format/system/output_file_impl.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 26;
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

Result<void> OutputFile::Impl::create(FolderHandle folder) {
  if (folder.descriptor() >= 0 && staged.create(std::move(folder), old ? kPrivate : kPublic)) return {};
  return cannot_write(path, std::strerror(errno));
}

Result<void> OutputFile::Impl::complete() const {
  const int file = staged.descriptor();
  if ((old && !keep_owner_and_mode(file, *old)) || ::fsync(file) != 0)
    return cannot_write(path, std::strerror(errno));
  return written ? read_back(file, written_bytes, *written, path) : Result<void>{};
}

OutputFile::OutputFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

Result<OutputFile> OutputFile::create(const fs::path& target) {
  auto impl = std::make_unique<Impl>();
  impl->path = target;
  impl->target = resolve_output(target);
  struct stat old {};
  if (::stat(target.c_str(), &old) == 0) {
    if (!S_ISREG(old.st_mode)) {
      return cannot_write(target, S_ISDIR(old.st_mode) ? "it is a folder" : "it is not a regular file");
    }
    if (::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
      return cannot_write(target, std::strerror(errno));
    impl->old = old;
  } else if (errno != ENOENT) {
    return cannot_write(target, std::strerror(errno));
  }
  if (target.filename().empty()) return cannot_write(target, "it names no file");
  FolderHandle folder;
  if (!folder.open(impl->target.parent_path())) return cannot_write(target, std::strerror(errno));
  SPLATLAS_RETURN_IF_ERROR(impl->create(std::move(folder)));
  return OutputFile(std::move(impl));
}

fs::path OutputFile::temporary() const {
  return impl_->staged.path();
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (!impl_->written) impl_->written.emplace();
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(impl_->staged.descriptor(), bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return cannot_write(impl_->path, std::strerror(errno));
    impl_->written->add(bytes.first(static_cast<std::size_t>(written)));
    impl_->written_bytes += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> OutputFile::commit() {
  return commit_files({this, 1});
}

Result<void> commit_files(std::span<OutputFile> files) {
  for (const OutputFile& file : files) SPLATLAS_RETURN_IF_ERROR(file.impl_->complete());
  const DeferInterrupts all_or_none;
  for (const OutputFile& file : files) {
    OutputFile::Impl& impl = *file.impl_;
    const FolderHandle& folder = impl.staged.folder();
    if (!impl.staged.publish(folder, impl.target.filename()))
      return cannot_write(impl.path, std::strerror(errno));
    if (!folder.sync()) return cannot_sync_folder(impl.path, std::strerror(errno));
  }
  return {};
}

Result<void> write_file(const fs::path& path, std::span<const std::byte> bytes) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes));
  return file.commit();
}

}  // namespace splatlas
