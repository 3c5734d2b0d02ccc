// Sparse zero-initialised memory.
#pragma once

#include <cstddef>

#include "format/result.h"

namespace splatlas {

/// A range of zeros in virtual memory. Only written pages are resident.
class SparseBytes {
 public:
  SparseBytes() = default;
  SparseBytes(SparseBytes&& other) noexcept;
  SparseBytes& operator=(SparseBytes&& other) noexcept;
  ~SparseBytes();

  /// Reserves address space without memory. kLimit if the system refuses.
  [[nodiscard]] static Result<SparseBytes> reserve(std::size_t bytes);
  /// Announces dense writes to a part, which may then be backed by large pages (2 MiB). Their page faults
  /// cost a third per byte. A hint: no effect on systems without large pages.
  void expect_dense(std::size_t first, std::size_t bytes);
  [[nodiscard]] std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::byte* mapped_ = nullptr;
  std::size_t mapped_bytes_ = 0;
  std::byte* data_ = nullptr;  // aligned to a large page
  std::size_t size_ = 0;
};

}  // namespace splatlas
