// How much a small input may cost.
#pragma once

#include <cstddef>
#include <cstdint>

namespace splatlas {

/// From its beginning to its end, more than a second of processor time, or more than 256 MiB of heap at once,
/// is a finding. Heap is counted where a sanitizer's allocator is in use, and time always; sanitizers make it
/// five to ten times as long, which is on the safe side.
class CostLimit {
 public:
  CostLimit();
  ~CostLimit();
  CostLimit(const CostLimit&) = delete;
  CostLimit& operator=(const CostLimit&) = delete;

  static constexpr double kMaxSeconds = 1;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

 private:
  double begun_seconds_;
};

}  // namespace splatlas
