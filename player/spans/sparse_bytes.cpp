#include "player/spans/sparse_bytes.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>

namespace splatlas {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

}  // namespace

SparseBytes::SparseBytes(SparseBytes&& other) noexcept
    : mapped_(std::exchange(other.mapped_, nullptr)),
      mapped_bytes_(std::exchange(other.mapped_bytes_, 0)),
      data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)) {}

SparseBytes& SparseBytes::operator=(SparseBytes&& other) noexcept {
  std::swap(mapped_, other.mapped_);
  std::swap(mapped_bytes_, other.mapped_bytes_);
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

SparseBytes::~SparseBytes() {
  if (mapped_ != nullptr) munmap(mapped_, mapped_bytes_);
}

Result<SparseBytes> SparseBytes::reserve(std::size_t bytes) {
  // Reserve slack to align the range to large pages.
  const std::size_t mapped_bytes = bytes + 2 * kLargePage;
  void* const mapped =
      mmap(nullptr, mapped_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED) {
    return fail(ErrorCode::kLimit,
                fmt::format("cannot reserve {} bytes of address space for grey values", bytes));
  }
  SparseBytes sparse;
  sparse.mapped_ = static_cast<std::byte*>(mapped);
  sparse.mapped_bytes_ = mapped_bytes;
  const std::size_t into_page = reinterpret_cast<std::uintptr_t>(mapped) % kLargePage;
  sparse.data_ = sparse.mapped_ + (into_page == 0 ? 0 : kLargePage - into_page);
  sparse.size_ = bytes;
  return sparse;
}

void SparseBytes::expect_dense(std::size_t first, std::size_t bytes) {
  const std::size_t last = std::min(first + bytes, size_);
  if (first >= last) return;
  const std::size_t from = first / kLargePage * kLargePage;
  const std::size_t to = (last + kLargePage - 1) / kLargePage * kLargePage;
  // A hint: kernels without large pages refuse it.
  static_cast<void>(madvise(data_ + from, to - from, MADV_HUGEPAGE));
}

}  // namespace splatlas
