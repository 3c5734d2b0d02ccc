// Limits on CPU time and heap memory of fuzz inputs and of operations on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace splatlas {

/// CPU seconds and bytes of heap.
struct Cost {
  double seconds = 0, bytes = 0;
};

/// A floor, and more for each byte of the input.
struct InputLimit {
  Cost floor, per_byte;

  [[nodiscard]] Cost of(std::size_t input_bytes) const {
    const auto n = static_cast<double>(input_bytes);
    return {floor.seconds + n * per_byte.seconds, floor.bytes + n * per_byte.bytes};
  }
};

/// A finding if CPU time, or heap held beyond that at construction, exceeds the limit before destruction.
/// Heap is counted with sanitizers only. Limits nest; not thread-safe. `what` names the operation.
class CostLimit {
 public:
  CostLimit(const Cost& limit, std::string what);
  ~CostLimit();
  CostLimit(const CostLimit&) = delete;
  CostLimit& operator=(const CostLimit&) = delete;

 private:
  Cost limit_;
  std::string what_;
  double begun_seconds_;
  std::int64_t begun_bytes_, max_bytes_outside_;
};

}  // namespace splatlas
