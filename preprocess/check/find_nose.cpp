#include "preprocess/check/find_nose.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace splatlas {

std::optional<Index3> find_nose(std::span<const std::uint8_t> mask, const Grid& grid) {
  constexpr double kSideMm = 25, kRiseMm = 12, kHeightMm = 10, kMinWidthMm = 90, kMaxWidthMm = 230;
  const std::int64_t width = grid.size[0], depth = grid.size[1];
  const auto side = static_cast<std::int64_t>(std::ceil(kSideMm / grid.spacing_mm[0]));
  const double rise = kRiseMm / grid.spacing_mm[1];
  std::vector<Index3> tips;  // one a slice, upwards
  const auto is_nose = [&] { return static_cast<double>(tips.size()) * grid.spacing_mm[2] >= kHeightMm; };
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    std::vector<std::int64_t> fronts(static_cast<std::size_t>(width), depth);
    std::int64_t first = width, last = -1;
    for (std::int64_t i = 0; i < width; ++i) {
      std::int64_t& front = fronts[static_cast<std::size_t>(i)];
      for (front = 0; front < depth && mask[static_cast<std::size_t>(grid.offset(i, front, k))] == 0;)
        ++front;
      if (front < depth) first = std::min(first, i), last = i;
    }
    const std::int64_t i = std::ranges::min_element(fronts) - fronts.begin();
    const double width_mm = static_cast<double>(last - first + 1) * grid.spacing_mm[0];
    const auto falls = [&](std::int64_t beside) {
      if (beside < 0 || beside >= width || fronts[static_cast<std::size_t>(beside)] == depth) return false;
      const std::int64_t fall =
          fronts[static_cast<std::size_t>(beside)] - fronts[static_cast<std::size_t>(i)];
      return static_cast<double>(fall) >= rise;
    };
    if (width_mm < kMinWidthMm || width_mm > kMaxWidthMm || !falls(i - side) || !falls(i + side)) {
      if (is_nose()) break;
      tips.clear();
    } else {
      tips.push_back({i, fronts[static_cast<std::size_t>(i)], k});
    }
  }
  return is_nose() ? std::optional(tips[tips.size() / 2]) : std::nullopt;
}

}  // namespace splatlas
