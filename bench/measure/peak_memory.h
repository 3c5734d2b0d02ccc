// Peak resident memory of the process.
#pragma once

#include <cstdint>

#include "format/result.h"

namespace splatlas {

/// Counts from start() on. One instance at a time: the system keeps one peak per process.
class PeakMemory {
 public:
  /// kFailed if the system has no peak that can be reset (Linux has).
  [[nodiscard]] static Result<PeakMemory> start();
  /// Peak resident bytes since start(), minus those at the start.
  [[nodiscard]] Result<std::uint64_t> grown_bytes() const;

 private:
  explicit PeakMemory(std::uint64_t before) : before_(before) {}
  std::uint64_t before_;
};

}  // namespace splatlas
