#include "player/render/decode/sparse_bytes.h"

#include <limits>

#include <sys/mman.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

}  // namespace

void SparseBytes::Unmap::operator()(std::byte* /*data*/) const {
  munmap(mapped, mapped_bytes);
}

Result<SparseBytes> SparseBytes::reserve(std::uint64_t bytes) {
  constexpr std::size_t kSlack = 2 * kLargePage;  // to align the range to large pages
  const bool fits = bytes <= std::numeric_limits<std::size_t>::max() - kSlack;
  const std::size_t size = fits ? static_cast<std::size_t>(bytes) : 0, mapped_bytes = size + kSlack;
  void* const mapped = fits ? mmap(nullptr, mapped_bytes, PROT_READ | PROT_WRITE,
                                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)
                            : MAP_FAILED;
  if (mapped == MAP_FAILED) {
    return fail(ErrorCode::kLimit,
                "cannot reserve {} bytes of address space for grey values; select less, or raise the "
                "program's limit of address space",
                bytes);
  }
  const std::size_t into_page = reinterpret_cast<std::uintptr_t>(mapped) % kLargePage;
  SparseBytes sparse;
  sparse.data_ = {static_cast<std::byte*>(mapped) + (into_page == 0 ? 0 : kLargePage - into_page),
                  Unmap{mapped, mapped_bytes, size}};
  return sparse;
}

void SparseBytes::expect_dense() {
  // A hint: kernels without large pages refuse it.
  static_cast<void>(madvise(data(), (size() + kLargePage - 1) / kLargePage * kLargePage, MADV_HUGEPAGE));
}

void SparseBytes::drop(std::size_t bytes) {
  constexpr std::size_t kPage = std::size_t{64} << 10;  // of any system
  const std::size_t from = (bytes + kPage - 1) / kPage * kPage;
  if (from < size()) static_cast<void>(madvise(data() + from, size() - from, MADV_DONTNEED));
}

}  // namespace splatlas
