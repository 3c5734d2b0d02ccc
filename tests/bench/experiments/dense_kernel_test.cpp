#include "bench/experiments/dense_kernel.h"

#include <cmath>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

/// Every pixel of a constant volume is 1 - (1 - a)^n, for any weights.
TEST(CompositeDense, OfAConstantVolumeIsTheClosedForm) {
  constexpr float kOpacity = 0.02f;
  for (const int planes : {2, 4}) {
    for (const int scale : {1, 2, 3}) {
      DenseVolume volume = DenseVolume::fog(37, 11, 9, planes);
      volume.values.assign(volume.values.size(), kOpacity);
      DenseSheet sheet{scale, {}};
      composite_dense(volume, sheet);
      const double expected = 1 - std::pow(1 - static_cast<double>(kOpacity), 9);
      const auto phases = static_cast<std::int64_t>(scale) * scale;
      ASSERT_EQ(static_cast<std::int64_t>(sheet.pixels.size()), 11 * phases * planes * volume.stride());
      for (std::int64_t row = 0; row < 11 * phases * planes; ++row) {
        for (std::int64_t x = 0; x < 37; ++x) {
          ASSERT_NEAR(sheet.pixels[static_cast<std::size_t>(row * volume.stride() + x)], expected, 1e-6);
        }
      }
    }
  }
}

TEST(CompositeDense, SplatsEveryVoxelOnFourPixels) {
  DenseVolume volume = DenseVolume::fog(20, 6, 1, 2);
  volume.values.assign(volume.values.size(), 0.0f);
  volume.values[static_cast<std::size_t>(volume.row(0, 3) - volume.values.data() + volume.stride() + 7)] = 1;
  DenseSheet sheet{2, {}};
  composite_dense(volume, sheet);
  double sum = 0;
  for (const float value : sheet.pixels) sum += value;
  // Two by two pixels per voxel: the tent covers 3 x 3 pixels: 1, 4 halves, 4 quarters.
  EXPECT_NEAR(sum, 1 + 4 * 0.5 + 4 * 0.25, 1e-6);
  EXPECT_EQ(samples(volume, 2), 20u * 6 * 4);
}

}  // namespace
}  // namespace splatlas
