#include "tests/support/page_residency.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path)
      : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

tl::unexpected<Error> failed(const std::filesystem::path& path, const char* what) {
  return fail(ErrorCode::kFailed, fmt::format("{}: {}: {}", path.string(), what, std::strerror(errno)));
}

}  // namespace

Result<std::uint64_t> resident_bytes(const std::filesystem::path& path) {
  const Descriptor file(path);
  const off_t size = file.number() < 0 ? -1 : ::lseek(file.number(), 0, SEEK_END);
  if (size < 0) return failed(path, "cannot be read");
  if (size == 0) return std::uint64_t{0};
  const auto bytes = static_cast<std::size_t>(size);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  // Mapping touches no page; no byte of it is read.
  void* const mapped = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.number(), 0);
  if (mapped == MAP_FAILED) return failed(path, "cannot be mapped");
  std::vector<unsigned char> resident((bytes + page - 1) / page);
  const int asked = ::mincore(mapped, bytes, resident.data());
  ::munmap(mapped, bytes);
  if (asked != 0) return failed(path, "the system does not tell which pages are in memory");
  std::uint64_t sum = 0;
  for (std::size_t n = 0; n < resident.size(); ++n) {
    if ((resident[n] & 1) != 0) sum += std::min(page, bytes - n * page);
  }
  return sum;
}

Result<void> evict(const std::filesystem::path& path) {
  {
    const Descriptor file(path);
    if (file.number() < 0 || ::fsync(file.number()) != 0) return failed(path, "cannot be synced");
    if (const int error = ::posix_fadvise(file.number(), 0, 0, POSIX_FADV_DONTNEED); error != 0) {
      errno = error;
      return failed(path, "cannot be evicted from memory");
    }
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t left, resident_bytes(path));
  if (left == 0) return {};
  return fail(ErrorCode::kFailed, fmt::format("{}: {} bytes stay in memory; set TMPDIR to a folder on a disk",
                                              path.string(), left));
}

}  // namespace splatlas
