#include "player/page/scale_bar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <fmt/format.h>

namespace splatlas {

double scale_bar_mm(double max_mm) {
  if (!(max_mm > 0) || !std::isfinite(max_mm)) return 0;
  const int exponent = static_cast<int>(std::floor(std::log10(max_mm)));
  constexpr double kRounding = 1 + 1e-12;  // a length of exactly one step is reached
  for (int e = exponent + 1; e >= exponent - 1; --e) {
    for (const double step : {5.0, 2.0, 1.0}) {
      const double length = e >= 0 ? step * std::pow(10, e) : step / std::pow(10, -e);
      if (length <= max_mm * kRounding) return length;
    }
  }
  return 0;
}

std::string length_text(double mm) {
  return fmt::format("{} mm", mm);
}

std::string direction_letters(const Vec3& direction_lps) {
  constexpr std::array<const char*, 3> kLetters{"LR", "PA", "SI"};  // towards +, towards -
  const double min_cosine = std::sin(std::numbers::pi / 8) - 1e-9;
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::ranges::stable_sort(axes, [&](std::size_t a, std::size_t b) {
    return std::abs(direction_lps[a]) > std::abs(direction_lps[b]) + 1e-9;
  });
  std::string letters;
  for (const std::size_t a : axes) {
    if (std::abs(direction_lps[a]) >= min_cosine) letters += kLetters[a][direction_lps[a] > 0 ? 0 : 1];
  }
  return letters;
}

}  // namespace splatlas
