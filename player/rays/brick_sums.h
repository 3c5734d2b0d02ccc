// Summed-area table of non-empty bricks (Crow 1984): O(1) emptiness test for any box of bricks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/rays/march_kernels.h"

namespace splatlas {

/// One byte per brick, x fastest: nonzero for non-empty bricks.
struct BrickMask {
  explicit BrickMask(const MarchGrid& grid)
      : x(grid.bricks(0)),
        y(grid.bricks(1)),
        z(grid.bricks(2)),
        bricks(static_cast<std::size_t>(x) * static_cast<std::size_t>(y) * static_cast<std::size_t>(z)) {}

  [[nodiscard]] std::size_t number(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * y + j) * x + i);
  }

  std::int64_t x, y, z;
  std::vector<std::uint8_t> bricks;
};

/// Summed-area table of a mask, as MarchSource::active.
[[nodiscard]] std::vector<std::uint32_t> brick_sums(const BrickMask& mask);

}  // namespace splatlas
