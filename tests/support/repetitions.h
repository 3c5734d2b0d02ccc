// Repetitions in tests, by the intensity of the build.
#pragma once

#include <cstdint>

namespace splatlas {

inline constexpr bool kAllRepetitions = SPLATLAS_TEST_INTENSITY >= 3;

/// Tests take every third member of a long series, from the first on, or all of them.
inline constexpr int kEveryNth = kAllRepetitions ? 1 : 3;

/// All of them, or a quarter, rounded up.
[[nodiscard]] constexpr std::uint32_t repetitions(std::uint32_t all) {
  return kAllRepetitions ? all : (all + 3) / 4;
}

}  // namespace splatlas
