// Repetitions in tests, fewer under sanitizers.
#pragma once

#include <cstdint>

namespace splatlas {

#ifdef SPLATLAS_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Sanitizers slow tests down five to fifteen times. With them, tests take every third member of a
/// long series, from the first on.
inline constexpr int kEveryNth = kSanitized ? 3 : 1;

/// All of them, or a quarter, rounded up, under sanitizers.
[[nodiscard]] constexpr std::uint32_t repetitions(std::uint32_t all) {
  return kSanitized ? (all + 3) / 4 : all;
}

}  // namespace splatlas
