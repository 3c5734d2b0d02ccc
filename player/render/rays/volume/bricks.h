// Bricks of ray volumes: masks for empty-space skipping, summed-area tables, and ranges of grey values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/atlas_reader.h"
#include "player/render/rays/march_kernels.h"

namespace splatlas {

/// Upper bound of a ray volume's memory: tables, and pages that these runs touch here and in the class cache.
[[nodiscard]] double bytes_of_ray_volume(const MarchGrid& grid, std::uint64_t runs);

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

  /// Number of bricks of a slice.
  [[nodiscard]] std::size_t of_slice() const { return number(0, 0, 1); }

  std::int64_t x, y, z;
  std::vector<std::uint8_t> bricks;
};

/// Summed-area table of a mask, as MarchSource::active (Crow 1984): O(1) emptiness test of a box.
[[nodiscard]] std::vector<std::uint32_t> brick_sums(const BrickMask& mask);

/// Minimum and maximum grey value at the corners of the cells of each brick, for one slice of bricks.
class BrickRanges {
 public:
  explicit BrickRanges(const MarchGrid& grid)
      : columns_(grid.bricks(0)),
        rows_(grid.bricks(1)),
        ranges_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  /// Adds `count` voxels along x from (x, y) on; `grey(n)` is the value of the n-th.
  template <typename Grey>
  void include(std::int64_t x, std::int64_t y, std::int64_t count, const Grey& grey) {
    const std::int64_t last_row = std::min(y / kSide, rows_ - 1);
    const std::int64_t first_row = y % kSide == 0 ? std::max<std::int64_t>(last_row - 1, 0) : last_row;
    for (std::int64_t column = std::max<std::int64_t>((x - 1) / kSide, 0);
         column < columns_ && column * kSide < x + count; ++column) {
      const std::int64_t from = std::max(x, column * kSide);
      const std::int64_t to = std::min(x + count, (column + 1) * kSide + 1);
      if (from >= to) continue;
      float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
      for (std::int64_t at = from; at < to; ++at) {
        const float g = grey(at - x);
        low = std::min(low, g);
        high = std::max(high, g);
      }
      for (std::int64_t row = first_row; row <= last_row; ++row) {
        Range& range = ranges_[static_cast<std::size_t>(row * columns_ + column)];
        range.low = std::min(range.low, low);
        range.high = std::max(range.high, high);
        range.voxels += static_cast<std::int32_t>(to - from);
      }
    }
  }

  /// Range of a brick, including the value 0 of any absent voxels. False for a brick without voxels.
  bool range(std::size_t brick, float& low, float& high) const {
    constexpr std::int64_t kVoxels = (kSide + 1) * (kSide + 1) * (kSide + 1);
    const Range& range = ranges_[brick];
    low = range.voxels < kVoxels ? std::min(range.low, 0.0f) : range.low;
    high = range.voxels < kVoxels ? std::max(range.high, 0.0f) : range.high;
    return range.voxels > 0;
  }

 private:
  static constexpr std::int64_t kSide = MarchGrid::kBrick;
  struct Range {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    std::int32_t voxels = 0;
  };
  std::int64_t columns_, rows_;
  std::vector<Range> ranges_;
};

/// Marks the bricks of the cells around a voxel within its slice.
inline void mark_around(const BrickMask& mask, std::vector<std::uint8_t>& bricks, std::int64_t x,
                        std::int64_t y) {
  for (std::int64_t j = (y - 1) / MarchGrid::kBrick; j <= y / MarchGrid::kBrick; ++j) {
    for (std::int64_t i = (x - 1) / MarchGrid::kBrick; i <= x / MarchGrid::kBrick; ++i) {
      bricks[static_cast<std::size_t>(j * mask.x + i)] = 1;
    }
  }
}

/// Marks the bricks of the cells in front of and behind the voxels that mark_around() marked: [slice][brick].
void mark_slices(BrickMask& mask, const std::vector<std::vector<std::uint8_t>>& slices);

}  // namespace splatlas
