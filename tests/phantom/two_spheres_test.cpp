#include "tests/phantom/two_spheres.h"

#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas::phantom {
namespace {

/// True if all 18 neighbours of (i, j, k) have its label. Asserts that the phantom stays clear of the border.
bool is_interior(const std::vector<std::uint8_t>& labels, int i, int j, int k) {
  const auto at = [&](int x, int y, int z) {
    return labels.at(static_cast<std::size_t>((z * kSize + y) * kSize + x));
  };
  for (int dk = -1; dk <= 1; ++dk) {
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const bool neighbour = std::abs(di) + std::abs(dj) + std::abs(dk) <= 2;
        if (neighbour && at(i + di, j + dj, k + dk) != at(i, j, k)) return false;
      }
    }
  }
  return true;
}

TEST(TwoSpheres, HasTheVoxelsOfThePapersTable1) {
  const auto volume = labels();
  ASSERT_EQ(volume.size(), kVoxels);
  std::uint64_t empty = 0, interior[2] = {}, boundary[2] = {};
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        const auto label = volume[static_cast<std::size_t>((k * kSize + j) * kSize + i)];
        if (label == 0) {
          ++empty;
        } else {
          ++(is_interior(volume, i, j, k) ? interior : boundary)[label - 1];
        }
      }
    }
  }
  EXPECT_EQ(empty, kEmptyVoxels);
  for (std::size_t ball = 0; ball < 2; ++ball) {
    EXPECT_EQ(interior[ball], kTable1[ball].interior) << kBalls[ball].name;
    EXPECT_EQ(boundary[ball], kTable1[ball].boundary) << kBalls[ball].name;
  }
}

TEST(TwoSpheres, TouchNeitherEachOtherNorTheBorder) {
  for (const Ball& ball : kBalls) {
    for (const int center : ball.center) {
      EXPECT_GE(center - ball.radius, 1);
      EXPECT_LE(center + ball.radius, kSize - 2);
    }
  }
  // No 26-neighbours: at least two voxels lie between the balls along some axis.
  for (int k = 1; k < kSize - 1; ++k) {
    for (int j = 1; j < kSize - 1; ++j) {
      for (int i = 1; i < kSize - 1; ++i) {
        if (!kBalls[0].holds(i, j, k)) continue;
        for (int n = 0; n < 27; ++n) {
          EXPECT_FALSE(kBalls[1].holds(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1));
        }
      }
    }
  }
}

TEST(TwoSpheres, GreyFallsFromTheCentreToTheBorderAndIsZeroOutside) {
  for (const Ball& ball : kBalls) {
    const auto [i, j, k] = ball.center;
    EXPECT_EQ(value_at(i, j, k), 250);
    EXPECT_EQ(value_at(i + ball.radius, j, k), 100);
    EXPECT_EQ(value_at(i + ball.radius + 1, j, k), 0);
    for (int d = 1; d <= ball.radius; ++d) EXPECT_LT(value_at(i + d, j, k), value_at(i + d - 1, j, k));
  }
}

}  // namespace
}  // namespace splatlas::phantom
