// Sparse zero-initialised memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "format/result.h"

namespace splatlas {

/// A range of zeros in virtual memory. Only written pages are resident.
class SparseBytes {
 public:
  /// Reserves address space without memory. kLimit if the system refuses, or addresses have too few bits.
  [[nodiscard]] static Result<SparseBytes> reserve(std::uint64_t bytes);
  /// Announces dense writes, so that it may be backed by large pages (2 MiB). Their page faults
  /// cost a third per byte. A hint: no effect on systems without large pages.
  void expect_dense();
  /// Frees the memory behind the first `bytes`. Later reads may find zeros, or size() is less.
  void drop(std::size_t bytes);
  [[nodiscard]] std::byte* data() const { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return data_ ? data_.get_deleter().size : 0; }

 private:
  struct Unmap {
    void* mapped;
    std::size_t mapped_bytes, size;
    void operator()(std::byte* data) const;
  };
  std::unique_ptr<std::byte, Unmap> data_;  // aligned to a large page
};

}  // namespace splatlas
