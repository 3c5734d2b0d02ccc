#include "format/io/input_file.h"

#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include "format/result_macros.h"

namespace splatlas {

namespace {

/// System calls transfer at most about 2 GiB.
constexpr std::size_t kMaxReadBytes = std::size_t{1} << 26;
/// Read-ahead is enabled after this fraction (1/16) of the file was requested.
constexpr std::uint64_t kReadAheadFraction = 16;

std::optional<std::uint64_t> size_now(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

}  // namespace

Result<InputFile> InputFile::open(const std::filesystem::path& path, bool map) {
  InputFile file;
  file.name_ = path.string();
  // O_NONBLOCK: opening a pipe would otherwise wait for a writer.
  file.descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file.descriptor_ < 0) {
    return fail(ErrorCode::kFailed, "{}: cannot be opened: {}", file.name_, std::strerror(errno));
  }
  struct stat status {};
  if (::fstat(file.descriptor_, &status) != 0) {
    return fail(ErrorCode::kFailed, "{}: cannot be read: {}", file.name_, std::strerror(errno));
  }
  if (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode)) {
    return fail(ErrorCode::kFailed, "{}: is a pipe; save the atlas to a file first", file.name_);
  }
  if (!S_ISREG(status.st_mode)) {
    return invalid_atlas("{}: not an atlas ({})", file.name_,
                         S_ISDIR(status.st_mode) ? "a folder" : "not a regular file");
  }
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  ::posix_fadvise(file.descriptor_, 0, 0, POSIX_FADV_RANDOM);
  if (map) file.map();
  return file;
}

void InputFile::map() {
  if (size_ == 0 || size_ > std::numeric_limits<std::size_t>::max()) return;
  void* const mapping = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (mapping == MAP_FAILED) return;
  mapping_ = static_cast<const std::byte*>(mapping);
  ::madvise(mapping, size_, MADV_RANDOM);
}

InputFile::InputFile(InputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      mapping_(std::exchange(other.mapping_, nullptr)),
      read_(std::move(other.read_)),
      size_(std::exchange(other.size_, 0)),
      name_(std::move(other.name_)),
      asked_bytes_(other.asked_bytes_.load()) {}

InputFile::~InputFile() {
  if (mapping_ != nullptr) ::munmap(const_cast<std::byte*>(mapping_), size_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

void InputFile::count(std::uint64_t bytes) const {
  const std::uint64_t asked = asked_bytes_.fetch_add(bytes, std::memory_order_relaxed);
  const std::uint64_t enough = size_ / kReadAheadFraction;
  if (asked > enough || enough - asked >= bytes) return;
  ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_NORMAL);
  if (mapping_ != nullptr) ::madvise(const_cast<std::byte*>(mapping_), size_, MADV_NORMAL);
}

std::size_t InputFile::copy_mapped(std::uint64_t offset, std::span<std::byte> to) const {
  // Read the pages of the range at once
  static const auto kPage = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t first = offset / kPage * kPage;
  if (to.size() > kPage)
    ::madvise(const_cast<std::byte*>(mapping_ + first), offset - first + to.size(), MADV_WILLNEED);

  std::size_t copied = 0;
  while (copied < to.size()) {
    const std::size_t bytes = std::min(to.size() - copied, kMaxReadBytes);
    const iovec here{to.data() + copied, bytes};
    const iovec there{const_cast<std::byte*>(mapping_ + offset + copied), bytes};
    const ssize_t got = ::process_vm_readv(::getpid(), &here, 1, &there, 1, 0);
    if (got <= 0) break;
    copied += static_cast<std::size_t>(got);
  }
  // The end of the last page of a truncated file reads as zeros.
  return size_now(descriptor_).value_or(0) >= offset + to.size() ? copied : 0;
}

Result<void> InputFile::read_positioned(std::uint64_t offset, std::span<std::byte> to) const {
  while (!to.empty()) {
    const ssize_t got =
        ::pread(descriptor_, to.data(), std::min(to.size(), kMaxReadBytes), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorCode::kFailed, "cannot be read: {}", std::strerror(errno));
    if (got == 0) {
      return invalid_atlas("truncated while open: ends at {}, had {} bytes",
                           size_now(descriptor_).value_or(offset), size_);
    }
    offset += static_cast<std::uint64_t>(got);
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

Result<void> InputFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  if (offset > size_ || to.size() > size_ - offset) {
    return invalid_atlas("truncated: bytes {} to {} of {}", offset, offset + to.size(), size_);
  }
  if (read_) return read_(offset, to);
  count(to.size());
  const std::size_t copied = mapping_ != nullptr ? copy_mapped(offset, to) : 0;
  // The rest, if any: pread() tells the reason for missing pages.
  return read_positioned(offset + copied, to.subspan(copied));
}

}  // namespace splatlas
