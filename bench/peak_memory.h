// The most memory that the process holds at once.
#pragma once

#include <cstdint>

#include "format/result.h"

namespace splatlas {

/// Counts from start() on. One at a time: the system keeps one peak per process.
class PeakMemory {
 public:
  /// kFailed where the system keeps no peak that can be set back (Linux does).
  [[nodiscard]] static Result<PeakMemory> start();
  /// Resident bytes at the peak since then, less those at the start.
  [[nodiscard]] Result<std::uint64_t> grown_bytes() const;

 private:
  explicit PeakMemory(std::uint64_t before) : before_(before) {}
  std::uint64_t before_;
};

}  // namespace splatlas
