// Limits on CPU time and heap memory of one fuzz input.
#pragma once

#include <cstddef>

namespace splatlas {

/// More than a second of CPU time, or more than 256 MiB of heap at once, between construction and destruction
/// is a finding. Heap is counted with sanitizers only. They slow programs down five to ten times, so that
/// their time limit is stricter.
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
