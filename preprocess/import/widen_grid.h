// Grids and volumes within a margin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

/// Voxels added at both ends of each axis of a grid.
struct Margin {
  Index3 low{0, 0, 0}, high{0, 0, 0};

  [[nodiscard]] bool empty() const { return low == Index3{0, 0, 0} && high == Index3{0, 0, 0}; }
};

/// The grid with a margin, and the margin of the axes before they were reordered.
[[nodiscard]] Grid widened(const Grid& grid, const Margin& margin);
[[nodiscard]] Margin before_reordering(const Margin& margin, const AxisOrder& order);

/// Voxels of a grid of `size`, within a margin of `fill`.
template <typename T>
[[nodiscard]] std::vector<T> widened(std::span<const T> voxels, const Index3& size, const Margin& margin,
                                     T fill) {
  Index3 all;
  for (std::size_t a = 0; a < 3; ++a) all[a] = size[a] + margin.low[a] + margin.high[a];
  std::vector<T> result(static_cast<std::size_t>(all[0] * all[1] * all[2]), fill);
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto from = voxels.subspan(static_cast<std::size_t>((k * size[1] + j) * size[0]),
                                       static_cast<std::size_t>(size[0]));
      std::ranges::copy(
          from, result.begin() + ((k + margin.low[2]) * all[1] + j + margin.low[1]) * all[0] + margin.low[0]);
    }
  }
  return result;
}

}  // namespace splatlas
