// Bytes of which most may never be written.
#pragma once

#include <cstddef>

#include "format/result.h"

namespace splatlas {

/// A range of zeros, backed by memory only where it has been written.
class SparseBytes {
 public:
  SparseBytes() = default;
  SparseBytes(SparseBytes&& other) noexcept;
  SparseBytes& operator=(SparseBytes&& other) noexcept;
  ~SparseBytes();

  /// Reserves address space, no memory. kLimit when the system refuses.
  [[nodiscard]] static Result<SparseBytes> reserve(std::size_t bytes);
  /// Much of a part will be written: it may be backed by large pages (2 MiB), of which the first touch costs
  /// a third of what it costs by small ones. Nothing where the system has none.
  void expect_dense(std::size_t first, std::size_t bytes);
  [[nodiscard]] std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::byte* mapped_ = nullptr;
  std::size_t mapped_bytes_ = 0;
  std::byte* data_ = nullptr;  // at the begin of a large page
  std::size_t size_ = 0;
};

}  // namespace splatlas
