// Allocator that fails at a chosen allocation.
#pragma once

#include <cstdint>

namespace splatlas {

/// Counts all allocations of the program, on all threads: malloc and its relatives, and thus operator new and
/// libraries. Sanitizers replace malloc: with them, only operator new counts.
class FailingAllocator {
 public:
  /// Makes allocation `number` (from 0) fail from now on; `lasting`: and all later ones.
  static void arm(std::uint64_t number, bool lasting);
  /// Ends the failures.
  static void disarm();
  /// Allocations since arm().
  [[nodiscard]] static std::uint64_t count();
  /// Blocks in use; 0 with sanitizers (AddressSanitizer detects leaks itself).
  [[nodiscard]] static std::int64_t live();
};

}  // namespace splatlas
