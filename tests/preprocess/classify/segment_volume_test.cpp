#include "preprocess/classify/segment_volume.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// The number of voxels of a rule; -1 if it is refused.
std::int64_t count(const VoxelBuffer& values, const Grid& grid, const std::string& rule) {
  const SegmentRule parsed = parse_segment("A=threshold:" + rule).value();
  std::vector<std::uint8_t> mask = voxels_between(values, parsed);
  return refine_segment(mask, grid, parsed) ? std::ranges::count(mask, 1) : -1;
}

struct Scene {
  Grid grid;
  VoxelBuffer values;
  float& at(std::int64_t i, std::int64_t j, std::int64_t k) {
    return values.as<float>()[grid.offset(i, j, k)];
  }
  [[nodiscard]] std::int64_t count(const std::string& rule) const {
    return splatlas::count(values, grid, rule);
  }
};

/// A hollow shell of 100 from 3 to 10 around value 10, in a background of 0, and a detached speck of 100.
Scene shell() {
  Scene scene;
  scene.grid.size = {14, 14, 14};
  scene.values = {VoxelType::kFloat32, std::vector<std::byte>(14 * 14 * 14 * 4)};
  for (std::int64_t k = 3; k <= 10; ++k) {
    for (std::int64_t j = 3; j <= 10; ++j) {
      for (std::int64_t i = 3; i <= 10; ++i) {
        const bool inside = std::min({i, j, k}) > 4 && std::max({i, j, k}) < 9;
        scene.at(i, j, k) = inside ? 10 : 100;
      }
    }
  }
  scene.at(0, 0, 0) = 100;
  return scene;
}

TEST(SegmentVolume, TakesTheLargestPieceWithItsHolesFilled) {
  const Scene scene = shell();
  EXPECT_EQ(scene.count("50"), 512);
  EXPECT_EQ(scene.count("otsu"), 512);
  EXPECT_EQ(scene.count("5:50"), 64);
}

TEST(SegmentVolume, LimitsAreIncluded) {
  const Scene scene = shell();
  EXPECT_EQ(scene.count("100:100"), 512);
  EXPECT_EQ(scene.count("100.5"), -1);
}

TEST(SegmentVolume, AHoleThatTheGridCutsOpenIsAHole) {
  Scene scene = shell();
  scene.grid.size[2] = 7;  // cut in the middle: the cavity is open at the last slice
  scene.values.bytes.resize(14 * 14 * 7 * 4);
  EXPECT_EQ(scene.count("50"), 8 * 8 * 4);
}

TEST(SegmentVolume, NarrowGapsAreClosedOnRequest) {
  Scene scene = shell();
  for (std::int64_t k = 3; k <= 4; ++k) scene.at(6, 6, k) = 0;  // a channel one voxel wide
  EXPECT_EQ(scene.count("50"), 512 - 64 - 2);
  EXPECT_EQ(scene.count("50:close=1"), 512);
}

/// Air in a body: chambers of 27 and 8 voxels, the air around, and a channel of one voxel between them.
TEST(SegmentVolume, ChoosesPieces) {
  Scene scene;
  scene.grid.size = {12, 9, 9};
  scene.values = {VoxelType::kFloat32, std::vector<std::byte>(12 * 9 * 9 * 4)};
  const auto fill = [&](const Index3& first, const Index3& last, float value) {
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
      for (std::int64_t j = first[1]; j <= last[1]; ++j) {
        for (std::int64_t i = first[0]; i <= last[0]; ++i) scene.at(i, j, k) = value;
      }
    }
  };
  fill({1, 1, 0}, {10, 7, 8}, 40);  // the body, cut by the first and last slice
  fill({2, 2, 2}, {4, 4, 4}, 0);
  fill({7, 2, 2}, {8, 3, 3}, 0);
  EXPECT_EQ(scene.count("-1:1:fill=no"), 12 * 9 * 9 - 10 * 7 * 9);
  EXPECT_EQ(scene.count("-1:1:inner"), 27);
  EXPECT_EQ(scene.count("-1:1:inner:pieces=2"), 35);
  EXPECT_EQ(scene.count("-1:1:seed=7.4,2,3"), 8);
  EXPECT_EQ(scene.count("-1:1:seed=6,6,6"), -1);
  fill({5, 3, 3}, {6, 3, 3}, 0);
  EXPECT_EQ(scene.count("-1:1:inner"), 37);
  EXPECT_EQ(scene.count("-1:1:inner:open=1"), 19);  // a ball of 19 voxels fits into the larger one
}

TEST(SegmentVolume, NumbersThatAreNoneAreOutside) {
  Scene scene = shell();
  scene.at(3, 3, 3) = std::nanf("");
  scene.at(10, 10, 10) = -INFINITY;
  EXPECT_EQ(scene.count("50"), 510);
  EXPECT_EQ(scene.count("otsu"), 510);
  scene.at(13, 13, 13) = -INFINITY;  // at a corner, as the speck is: neither is a hole, as the shell has one
  EXPECT_EQ(scene.count("-5000:0.5"), 14 * 14 * 14 - 2);
}

TEST(SegmentVolume, EveryTypeIsComparedExactly) {
  const Grid grid{.size = {2, 1, 1}};
  VoxelBuffer large{VoxelType::kUInt32, std::vector<std::byte>(8)};
  large.as<std::uint32_t>()[0] = 4294967294u;
  large.as<std::uint32_t>()[1] = 4294967295u;
  EXPECT_EQ(count(large, grid, "4294967295"), 1);
  VoxelBuffer fine{VoxelType::kFloat64, std::vector<std::byte>(16)};
  fine.as<double>()[0] = 1;
  fine.as<double>()[1] = 1 + 1e-15;
  EXPECT_EQ(count(fine, grid, "1.000000000000001"), 1);
}

TEST(ParseSegment, ReadsRules) {
  const auto mask = parse_segment("Rest of brain=mask:a=b.nii");
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->name, "Rest of brain");
  EXPECT_EQ(mask->kind, SegmentRule::Kind::kMask);
  EXPECT_EQ(mask->mask, "a=b.nii");
  const auto opened = value_or_throw(parse_segment("Rest=mask:a.nii:open=1.5"));
  EXPECT_EQ(opened.mask, "a.nii");
  EXPECT_EQ(opened.open_mm, 1.5);
  const auto overlapping = value_or_throw(parse_segment("Tumour=mask:a.nii:open=2:overlap"));
  EXPECT_TRUE(overlapping.overlaps && !opened.overlaps);
  EXPECT_EQ(overlapping.mask, "a.nii");
  EXPECT_EQ(overlapping.open_mm, 2);
  const auto range = value_or_throw(parse_segment("Bone=threshold:-1.5:3e2:close=2.5"));
  EXPECT_EQ(range.low, -1.5);
  EXPECT_EQ(range.high, 300);
  EXPECT_EQ(range.close_mm, 2.5);
  EXPECT_EQ(parse_segment("Bone=threshold:otsu:close=1")->kind, SegmentRule::Kind::kOtsu);
  const auto isosurface = value_or_throw(parse_segment("Skull=iso:-2.5:within= Head, left"));
  EXPECT_EQ(isosurface.kind, SegmentRule::Kind::kIsosurface);
  EXPECT_EQ(isosurface.low, -2.5);
  EXPECT_EQ(isosurface.within, "Head, left");
  EXPECT_EQ(parse_segment("Skin=iso:3")->within, "");
  const auto all = value_or_throw(parse_segment(
      "Lung=threshold:-1000:-500:within=Body:pieces=2:inner:seed=1,2,-3:fill=no:overlap:color=#ff8000"));
  EXPECT_EQ(all.within, "Body");
  EXPECT_EQ(all.pieces, 2u);
  EXPECT_EQ(all.seed_lps_mm, (Vec3{1, 2, -3}));
  EXPECT_TRUE(all.inner && !all.fills && all.overlaps);
  EXPECT_EQ(all.color, (Rgb{255, 128, 0}));
  for (const char* wrong : {"",
                            "A=threshold:1:pieces=0",
                            "A=threshold:1:seed=1,2",
                            "A=threshold:1:within=",
                            "A=threshold:1:color=red",
                            "A=mask:x:inner",
                            "A",
                            "=mask:x",
                            "A=",
                            "A=mask:",
                            "A=threshold:",
                            "A=threshold:x",
                            "A=threshold:3:2",
                            "A=threshold:1:2:3",
                            "A=threshold:nan",
                            "A=otsu",
                            "A=mask::open=1",
                            "A=mask:x:open=y",
                            "A=mask:x:open=51",
                            "A=iso:",
                            "A=iso:x",
                            "A=iso:nan",
                            "A=iso:inf",
                            "A=iso:1,B",
                            "A=iso:1:close=2",
                            "A=threshold:1:close=-1",
                            "A=threshold:1:close=x"}) {
    EXPECT_THAT(parse_segment(wrong), FailsWith(ErrorCode::kUsage, HasSubstr("NAME=mask:FILE"))) << wrong;
  }
}

}  // namespace
}  // namespace splatlas
