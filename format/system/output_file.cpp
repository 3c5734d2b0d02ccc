#include "format/system/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/system/ascii_text.h"
#include "format/system/checksum.h"
#include "format/system/interrupts.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"
#include "format/system/temporary_entry.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 26;
constexpr std::size_t kReadBackBytes = std::size_t{1} << 20;
constexpr mode_t kPermissions = 07777;

/// Copies owner, group and permissions of the old file. Only root can keep another owner. If the group cannot
/// be kept, the new group gets the permissions of others.
bool keep_owner_and_mode(int descriptor, const struct stat& old) {
  struct stat now {};
  if (::fstat(descriptor, &now) != 0) return false;
  mode_t mode = old.st_mode & kPermissions;
  const bool other_owner = now.st_uid != old.st_uid || now.st_gid != old.st_gid;
  if (other_owner && ::fchown(descriptor, old.st_uid, old.st_gid) != 0 && now.st_gid != old.st_gid &&
      ::fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) != 0) {
    mode = (mode & ~(S_IRWXG | S_ISGID)) | (mode & S_IRWXO) << 3;
  }
  return ::fchmod(descriptor, mode) == 0;
}

/// File extension; ".nii.gz" counts as one.
std::string ending_of(const fs::path& path) {
  const std::string last = path.extension().string();
  return to_lower(last) == ".gz" ? path.stem().extension().string() + last : last;
}

}  // namespace

/// Functions that return bool set errno on failure.
struct OutputFile::Impl {
  explicit Impl(fs::path output) : path(std::move(output)), target(resolve_output(path)) {}

  /// Sets owner and permissions and syncs the temporary file.
  [[nodiscard]] bool complete();
  /// Verifies that the file contains the bytes of write().
  [[nodiscard]] Result<void> read_back() const;

  fs::path path, target;
  std::optional<struct stat> old;
  TemporaryEntry temporary;
  std::optional<RunningChecksum> written;  // of the bytes of write(), if it was called
  std::uint64_t written_bytes = 0;
};

bool OutputFile::Impl::complete() {
  return temporary.follow_name() && (!old || keep_owner_and_mode(temporary.descriptor(), *old)) &&
         ::fsync(temporary.descriptor()) == 0;
}

Result<void> OutputFile::Impl::read_back() const {
  if (!written) return {};
  // Drop cached pages, so that reads come from the disk if possible.
  ::posix_fadvise(temporary.descriptor(), 0, 0, POSIX_FADV_DONTNEED);
  RunningChecksum read;
  std::vector<std::byte> piece(std::min<std::uint64_t>(kReadBackBytes, written_bytes + 1));
  for (std::uint64_t offset = 0;;) {
    const ssize_t got =
        ::pread(temporary.descriptor(), piece.data(), piece.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannot_write(path, fmt::format("reading it back: {}", std::strerror(errno)));
    if (got == 0 && offset == written_bytes && read.value() == written->value()) return {};
    if (got == 0) return cannot_write(path, "other bytes come back from the disk than were written");
    offset += static_cast<std::uint64_t>(got);
    read.add(std::span(piece).first(static_cast<std::size_t>(got)));
  }
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
      return cannot_write(target, S_ISDIR(old.st_mode) ? "it is a folder" : "it is not a regular file");
    }
    if (::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
      return cannot_write(target, std::strerror(errno));
    impl->old = old;
  } else if (errno != ENOENT) {
    return cannot_write(target, std::strerror(errno));
  }
  if (target.filename().empty()) return cannot_write(target, "it names no file");
  // Create it in the target's folder: a rename must not cross file systems.
  const fs::path folder = impl->target.parent_path();
  remove_stale_temporaries(folder);
  if (!impl->temporary.make(folder, TemporaryEntry::Kind::kFile, ending))
    return cannot_write(target, std::strerror(errno));
  return OutputFile(std::move(impl));
}

const fs::path& OutputFile::temporary() const {
  return impl_->temporary.path();
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (!impl_->written) impl_->written.emplace();
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(impl_->temporary.descriptor(), bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
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
  for (const OutputFile& file : files) {
    if (!file.impl_->complete()) return cannot_write(file.impl_->path, std::strerror(errno));
    SPLATLAS_RETURN_IF_ERROR(file.impl_->read_back());
  }
  const DeferInterrupts all_or_none;
  for (const OutputFile& file : files) {
    OutputFile::Impl& impl = *file.impl_;
    if (!impl.temporary.rename_to(impl.target)) return cannot_write(impl.path, std::strerror(errno));
    SPLATLAS_RETURN_IF_ERROR(sync_folder_of(impl.target, impl.path));
  }
  return {};
}

Result<void> write_file(const fs::path& path, std::span<const std::byte> bytes) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes));
  return file.commit();
}

Result<void> write_atomically(const fs::path& path,
                              const std::function<Result<void>(const fs::path&)>& write) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path, ending_of(path)));
  SPLATLAS_RETURN_IF_ERROR(write(file.temporary()));
  return file.commit();
}

std::string with_path(std::string message, const fs::path& temporary, const fs::path& path) {
  const std::string &from = temporary.native(), &to = path.native();
  for (std::size_t at = message.find(from); at != std::string::npos; at = message.find(from, at + to.size()))
    message.replace(at, from.size(), to);
  return message;
}

}  // namespace splatlas
