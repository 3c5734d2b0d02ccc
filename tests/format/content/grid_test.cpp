#include "format/content/grid.h"

#include <cstring>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"
#include "tests/support/axis_orders.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

double real(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Axes rotated by any angles, mirrored half of the time.
Matrix3 random_direction(std::mt19937& random) {
  const double a = real(random, -3.2, 3.2);
  const double b = real(random, -3.2, 3.2);
  const double c = real(random, -3.2, 3.2);
  const double mirror = real(random, 0, 1) < 0.5 ? -1 : 1;
  return {std::cos(a) * std::cos(b),
          std::cos(a) * std::sin(b) * std::sin(c) - std::sin(a) * std::cos(c),
          mirror * (std::cos(a) * std::sin(b) * std::cos(c) + std::sin(a) * std::sin(c)),
          std::sin(a) * std::cos(b),
          std::sin(a) * std::sin(b) * std::sin(c) + std::cos(a) * std::cos(c),
          mirror * (std::sin(a) * std::sin(b) * std::cos(c) - std::cos(a) * std::sin(c)),
          -std::sin(b),
          std::cos(b) * std::sin(c),
          mirror * (std::cos(b) * std::cos(c))};
}

Grid random_grid(std::mt19937& random) {
  Grid grid;
  for (auto& n : grid.size) n = std::uniform_int_distribution<std::int64_t>(1, 9)(random);
  for (auto& mm : grid.spacing_mm) mm = real(random, 0.1, 4);
  for (auto& mm : grid.origin_lps_mm) mm = real(random, -200, 200);
  grid.direction_lps = random_direction(random);
  return grid;
}

/// The old voxel at the place of a new voxel.
Index3 old_voxel(const Index3& voxel, const Index3& old_size, const AxisOrder& order) {
  Index3 old{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t source = order.from[a];
    old[source] = order.flipped[a] ? old_size[source] - 1 - voxel[a] : voxel[a];
  }
  return old;
}

Vec3 as_real(const Index3& voxel) {
  return {static_cast<double>(voxel[0]), static_cast<double>(voxel[1]), static_cast<double>(voxel[2])};
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(Grid, CountsAndPlacesVoxelsWithIFastest) {
  const Grid grid{.size = {3, 4, 5}};
  EXPECT_EQ(grid.voxels(), 60);
  std::int64_t expected = 0;
  for_each_voxel(grid.size, [&](const Index3& v) { EXPECT_EQ(grid.offset(v[0], v[1], v[2]), expected++); });
  EXPECT_TRUE(grid.contains(0, 0, 0));
  EXPECT_TRUE(grid.contains(2, 3, 4));
  EXPECT_FALSE(grid.contains(3, 0, 0));
  EXPECT_FALSE(grid.contains(0, 4, 0));
  EXPECT_FALSE(grid.contains(0, 0, 5));
  EXPECT_FALSE(grid.contains(-1, 0, 0));
}

TEST(Grid, ReferenceLengthIsTheCubeRootOfAShearedVoxel) {
  // Columns (1, 0, 0), (1.9, 0.3, 0) and (0, 0, 3): a voxel of 1 * 0.3 * 3 mm^3.
  const double length = std::hypot(1.9, 0.3);
  const Grid sheared{.size = {4, 4, 4},
                     .spacing_mm = {1, length, 3},
                     .direction_lps = {1, 1.9 / length, 0, 0, 0.3 / length, 0, 0, 0, 1}};
  EXPECT_NEAR(reference_length_mm(sheared), std::cbrt(0.9), 1e-15);
  Grid mirrored = sheared;
  mirrored.direction_lps[8] = -1;
  EXPECT_NEAR(reference_length_mm(mirrored), std::cbrt(0.9), 1e-15);
  // Columns of other lengths than 1 scale the voxel, too.
  EXPECT_NEAR(reference_length_mm({.spacing_mm = {1, 2, 3}, .direction_lps = {2, 0, 0, 0, 1, 0, 0, 0, -1}}),
              std::cbrt(12), 1e-15);
}

TEST(Grid, IndexToMmIsTheFormulaOfItk) {
  const Grid grid{{10, 10, 10}, {1, 2, 3}, {10, 20, 30}, {0, -1, 0, 1, 0, 0, 0, 0, 1}};
  EXPECT_EQ(index_to_lps_mm(grid).apply({0, 0, 0}), (Vec3{10, 20, 30}));
  EXPECT_EQ(index_to_lps_mm(grid).apply({1, 0, 0}), (Vec3{10, 21, 30}));  // i points to +P
  EXPECT_EQ(index_to_lps_mm(grid).apply({0, 1, 0}), (Vec3{8, 20, 30}));   // j points to -L
  EXPECT_EQ(index_to_lps_mm(grid).apply({4, 5, 6}), (Vec3{0, 24, 48}));
  EXPECT_EQ(index_to_lps_mm(grid).apply_linear({4, 5, 6}), (Vec3{-10, 4, 18}));
}

RC_GTEST_PROP(Grid, MmToIndexGoesBack, ()) {
  auto random = *random_source();
  const Grid grid = random_grid(random);
  const Vec3 index{real(random, -50, 50), real(random, -50, 50), real(random, -50, 50)};
  RC_ASSERT(distance(lps_mm_to_index(grid).apply(index_to_lps_mm(grid).apply(index)), index) < 1e-9);
}

RC_GTEST_PROP(Grid, ReorderedVoxelsStayWhereTheyAre, ()) {
  auto random = *random_source();
  const Grid grid = random_grid(random);
  const Affine old_to_mm = index_to_lps_mm(grid);
  for (const AxisOrder& order : all_axis_orders()) {
    const Grid turned = reordered(grid, order);
    RC_ASSERT(turned.voxels() == grid.voxels());
    const Affine to_mm = index_to_lps_mm(turned);
    for_each_voxel(turned.size, [&](const Index3& voxel) {
      const Vec3 expected = old_to_mm.apply(as_real(old_voxel(voxel, grid.size, order)));
      RC_ASSERT(distance(to_mm.apply(as_real(voxel)), expected) < 1e-10);
    });
  }
}

RC_GTEST_PROP(Grid, InverseOrderGoesBack, ()) {
  auto random = *random_source();
  const Grid grid = random_grid(random);
  for (const AxisOrder& order : all_axis_orders()) {
    const Grid back = reordered(reordered(grid, order), inverse(order));
    RC_ASSERT(inverse(inverse(order)) == order);
    RC_ASSERT(back.size == grid.size);
    RC_ASSERT(back.spacing_mm == grid.spacing_mm);
    RC_ASSERT(back.direction_lps == grid.direction_lps);
    RC_ASSERT(distance(back.origin_lps_mm, grid.origin_lps_mm) < 1e-10);
  }
}

RC_GTEST_PROP(Grid, VoxelsAreReorderedAsTheGridIs, ()) {
  auto random = *random_source();
  Index3 size{};
  for (auto& n : size) n = std::uniform_int_distribution<std::int64_t>(1, random() % 4 == 0 ? 70 : 6)(random);
  const std::size_t width = std::vector<std::size_t>{1, 2, 3, 4, 8, 12}[random() % 6];
  const Grid grid{.size = size};
  const auto bytes = static_cast<std::size_t>(grid.voxels()) * width;
  std::vector<unsigned char> volume(bytes);
  for (auto& byte : volume) byte = static_cast<unsigned char>(random());
  const AxisOrder order = all_axis_orders()[random() % 48];

  std::vector<unsigned char> turned(bytes);
  reorder_voxels(volume.data(), size, order, width, turned.data());

  const Grid turned_grid = reordered(grid, order);
  for_each_voxel(turned_grid.size, [&](const Index3& v) {
    const Index3 old = old_voxel(v, size, order);
    const auto to = static_cast<std::size_t>(turned_grid.offset(v[0], v[1], v[2])) * width;
    const auto from = static_cast<std::size_t>(grid.offset(old[0], old[1], old[2])) * width;
    RC_ASSERT(std::memcmp(&turned[to], &volume[from], width) == 0);
  });
  std::vector<unsigned char> back(bytes);
  reorder_voxels(turned.data(), turned_grid.size, inverse(order), width, back.data());
  RC_ASSERT(back == volume);
}

TEST(AxisStorageOrder, EveryAxisOrderOfAVolumeIsStoredAlike) {
  // Oblique, with each axis nearest to another anatomical axis.
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  const Grid stored{{5, 6, 7}, {1, 2, 3}, {-90, -126, -72}, {c, -s, 0, s, c, 0, 0, 0, 1}};
  ASSERT_TRUE(storage_order(stored).is_identity());
  for (const AxisOrder& order : all_axis_orders()) {
    const Grid file = reordered(stored, order);
    EXPECT_EQ(storage_order(file), inverse(order));
    const Grid again = reordered(file, storage_order(file));
    EXPECT_EQ(again.size, stored.size);
    EXPECT_EQ(again.spacing_mm, stored.spacing_mm);
    EXPECT_EQ(again.direction_lps, stored.direction_lps);
    EXPECT_LT(distance(again.origin_lps_mm, stored.origin_lps_mm), 1e-12);
  }
}

RC_GTEST_PROP(AxisStorageOrder, NoOtherOrderRunsCloser, ()) {
  auto random = *random_source();
  const Grid grid = random_grid(random);
  const auto closeness = [&](const AxisOrder& order) {
    const Grid turned = reordered(grid, order);
    return turned.direction_lps[0] + turned.direction_lps[4] + turned.direction_lps[8];
  };
  const double chosen = closeness(storage_order(grid));
  for (const AxisOrder& order : all_axis_orders()) RC_ASSERT(closeness(order) <= chosen + 1e-12);
  const Grid turned = reordered(grid, storage_order(grid));
  for (const std::size_t diagonal : {0u, 4u, 8u}) RC_ASSERT(turned.direction_lps[diagonal] >= 0);
}

TEST(AxisStorageOrder, TiesGoToTheFirstPermutation) {
  // i and j lie midway between L and P: both orders are equally near.
  const double h = std::numbers::sqrt2 / 2;
  const Grid grid{.size = {2, 3, 4}, .direction_lps = {h, h, 0, h, -h, 0, 0, 0, 1}};
  EXPECT_EQ(storage_order(grid), (AxisOrder{{0, 1, 2}, {false, true, false}}));
}

TEST(ValidateGrid, TakesWhatFilesHold) {
  EXPECT_TRUE(validate({.size = {1, 1, 1}}, "g"));
  EXPECT_TRUE(validate({.size = {kMaxAxisSize, 1 << 16, 1}}, "g"));
  EXPECT_TRUE(validate({.size = {181, 217, 181}, .direction_lps = {-1, 0, 0, 0, -1, 0, 0, 0, 1}}, "g"));
  EXPECT_TRUE(validate({.size = {2, 2, 2}, .spacing_mm = {1e-3, 1e3, 1}}, "g"));
  EXPECT_TRUE(
      validate({.size = {2, 2, 2}, .spacing_mm = {1e-9, 1e9, 1}, .origin_lps_mm = {1e15, -1e15, 0}}, "g"));
}

}  // namespace
}  // namespace splatlas
