// Memory that runs out at a chosen moment.
#pragma once

#include <cstdint>

namespace splatlas {

/// Every allocation of the program is counted, on all threads: by malloc and its kin, and so by operator new
/// and by libraries. With sanitizers, which have a malloc of their own, those by operator new alone.
class FailingAllocator {
 public:
  /// From now on, allocation `number` (from 0) fails; `lasting`: and all after it.
  static void arm(std::uint64_t number, bool lasting);
  /// No more failures.
  static void disarm();
  /// Since arm().
  [[nodiscard]] static std::uint64_t count();
  /// Blocks that are allocated now; 0 with sanitizers: AddressSanitizer finds leaks itself.
  [[nodiscard]] static std::int64_t live();
};

}  // namespace splatlas
