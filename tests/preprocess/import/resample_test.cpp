#include <gtest/gtest.h>

#include "preprocess/import/images/import_image.h"
#include "tests/preprocess/random_images.h"

namespace splatlas {
namespace {

/// 3 f(x, y, z) = 2 x - y + 5 z in mm, which linear interpolation keeps.
Image ramp(const Grid& grid) {
  Image image = zeros(grid, VoxelType::kFloat64);
  const Affine to_mm = index_to_lps_mm(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 mm = to_mm.apply({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        image.voxels.as<double>()[grid.offset(i, j, k)] = 2 * mm[0] - mm[1] + 5 * mm[2];
      }
    }
  }
  return image;
}

const Grid kSource{.size = {9, 8, 7},
                   .spacing_mm = {1, 2, 0.5},
                   .origin_lps_mm = {-3, 4, 1},
                   .direction_lps = {0, 1, 0, -1, 0, 0, 0, 0, 1}};

TEST(Resample, LinearKeepsRamps) {
  const Image source = ramp(kSource);
  // Within the source: its x runs along j, its -y along i.
  const Grid inner{.size = {4, 5, 3}, .spacing_mm = {0.7, 0.9, 0.31}, .origin_lps_mm = {-1.5, -2.5, 1.7}};
  const Image expected = ramp(inner);
  const VoxelBuffer found = resample_linear(source, inner);
  for (std::int64_t v = 0; v < inner.voxels(); ++v)
    EXPECT_NEAR(found.as<double>()[v], expected.voxels.as<double>()[v], 1e-12);
}

TEST(Resample, BeyondTheImageIsItsLeastValueOrZero) {
  Image source = zeros({.size = {2, 1, 1}}, VoxelType::kInt16);
  source.voxels.as<std::int16_t>()[0] = -1000;
  source.voxels.as<std::int16_t>()[1] = 7;
  const Grid wide{.size = {5, 1, 1}, .spacing_mm = {0.5, 1, 1}, .origin_lps_mm = {-1, 0, 0}};
  const VoxelBuffer linear = resample_linear(source, wide),
                    nearest = resample_nearest(source.voxels, source.grid, wide);
  const std::vector<std::int16_t> values(linear.as<std::int16_t>(), linear.as<std::int16_t>() + 5),
      labels(nearest.as<std::int16_t>(), nearest.as<std::int16_t>() + 5);
  EXPECT_EQ(values, (std::vector<std::int16_t>{-1000, -1000, -1000, -496, 7}));  // -496.5 is rounded upwards
  EXPECT_EQ(labels, (std::vector<std::int16_t>{0, -1000, -1000, 7, 7}));
}

/// Labels of a part of a volume have a margin, whatever the order of their axes.
TEST(Resample, FindsPartsOfALattice) {
  const Grid whole = reordered(kSource, storage_order(kSource));
  Grid part = whole;
  part.origin_lps_mm = index_to_lps_mm(whole).apply({2, 1, 3});
  part.size = {5, 4, 2};
  const Grid turned = reordered(part, AxisOrder{{2, 0, 1}, {true, false, true}});
  const Margin margin = margin_around(turned, kSource).value();
  EXPECT_EQ(margin.low, (Index3{2, 1, 3}));
  for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(margin.low[a] + part.size[a] + margin.high[a], whole.size[a]);
  EXPECT_TRUE(margin_around(kSource, kSource)->empty());
  EXPECT_TRUE(margin_around(kSource, turned)->empty());  // it holds them
  part.origin_lps_mm[0] += 0.1;
  EXPECT_FALSE(margin_around(part, kSource));
}

TEST(Resample, NearestPermutesEveryLayer) {
  std::mt19937 random(3);
  const Image one = random_volume(kSource, VoxelType::kUInt16, random),
              two = random_volume(kSource, VoxelType::kUInt16, random);
  VoxelBuffer layers = one.voxels;
  layers.bytes.insert(layers.bytes.end(), two.voxels.bytes.begin(), two.voxels.bytes.end());
  const AxisOrder order{{2, 0, 1}, {true, false, true}};
  const VoxelBuffer moved = resample_nearest(layers, kSource, reordered(kSource, order));
  std::vector<std::byte> expected(layers.bytes.size());
  const std::size_t half = expected.size() / 2;
  reorder_voxels(one.voxels.bytes.data(), kSource.size, order, 2, expected.data());
  reorder_voxels(two.voxels.bytes.data(), kSource.size, order, 2, &expected[half]);
  EXPECT_EQ(moved.bytes, expected);
}

TEST(Resample, MeasuresOverlap) {
  const Grid grid{.size = {10, 10, 10}};
  EXPECT_EQ(overlap(grid, grid), 1);
  Grid half = grid;
  half.origin_lps_mm[1] += 5;
  EXPECT_EQ(overlap(grid, half), 0.5);
  half.origin_lps_mm[1] += 6;
  EXPECT_EQ(overlap(grid, half), 0);
}

}  // namespace
}  // namespace splatlas
