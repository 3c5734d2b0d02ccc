#include <random>

#include <gtest/gtest.h>

#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {
namespace {

/// Every box of bricks, summed from the table and brick by brick.
TEST(BrickSums, AnyBoxIsCounted) {
  MarchGrid grid;
  grid.size = {17, 9, 12};
  BrickMask mask(grid);
  ASSERT_EQ(mask.bricks.size(), 5u * 3u * 3u);
  std::mt19937 random(1);
  for (std::uint8_t& brick : mask.bricks) brick = random() % 3 == 0 ? 1 : 0;
  const std::vector<std::uint32_t> sums = brick_sums(mask);
  const auto sum = [&](int x, int y, int z) { return sums[static_cast<std::size_t>((z * 4 + y) * 6 + x)]; };
  const auto counted = [&](int x, int y, int z) {
    std::uint32_t count = 0;
    for (int k = 0; k < z; ++k) {
      for (int j = 0; j < y; ++j) {
        for (int i = 0; i < x; ++i) count += mask.bricks[mask.number(i, j, k)];
      }
    }
    return count;
  };
  for (int z = 0; z <= 3; ++z) {
    for (int y = 0; y <= 3; ++y) {
      for (int x = 0; x <= 5; ++x) EXPECT_EQ(sum(x, y, z), counted(x, y, z)) << x << ' ' << y << ' ' << z;
    }
  }
}

}  // namespace
}  // namespace splatlas
