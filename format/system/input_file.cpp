#include "format/system/input_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/system/result_macros.h"

namespace splatlas {

namespace {

/// pread transfers at most about 2 GiB. Smaller blocks also hold the file's lock for a shorter time.
constexpr std::size_t kMaxReadBytes = std::size_t{1} << 26;
/// Read-ahead is enabled after this fraction (1/16) of the file was requested.
constexpr std::uint64_t kReadAheadFraction = 16;

}  // namespace

Result<InputFile> InputFile::open(const std::filesystem::path& path) {
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
  if (!S_ISREG(status.st_mode)) {
    return invalid_atlas("{}: not an atlas ({})", file.name_,
                         S_ISDIR(status.st_mode) ? "a folder" : "not a regular file");
  }
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  ::posix_fadvise(file.descriptor_, 0, 0, POSIX_FADV_RANDOM);
  return file;
}

InputFile::InputFile(std::vector<std::byte> bytes, std::string name)
    : bytes_(std::move(bytes)), size_(bytes_.size()), name_(std::move(name)) {}

InputFile::InputFile(InputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(std::move(other.bytes_)),
      size_(std::exchange(other.size_, 0)),
      name_(std::move(other.name_)),
      asked_bytes_(other.asked_bytes_.load()) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> InputFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  if (offset > size_ || to.size() > size_ - offset) {
    return invalid_atlas("truncated: bytes {} to {} of {}", offset, offset + to.size(), size_);
  }
  if (descriptor_ < 0) {
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), to.size(), to.begin());
    return {};
  }
  const std::uint64_t asked = asked_bytes_.fetch_add(to.size(), std::memory_order_relaxed);
  const std::uint64_t enough = size_ / kReadAheadFraction;
  if (asked <= enough && enough - asked < to.size()) ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_NORMAL);
  while (!to.empty()) {
    const ssize_t got =
        ::pread(descriptor_, to.data(), std::min(to.size(), kMaxReadBytes), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorCode::kFailed, "cannot be read: {}", std::strerror(errno));
    if (got == 0) return invalid_atlas("truncated while open: ends at {}, had {} bytes", offset, size_);
    offset += static_cast<std::uint64_t>(got);
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

}  // namespace splatlas
