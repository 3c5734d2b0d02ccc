#include "tests/reference/masked_volume.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tests/support/test_content.h"

namespace splatlas::reference {
namespace {

AtlasContent two_halves(const VoxelBuffer& values) {
  TestVolume volume;
  volume.grid.size = {4, 3, 3};
  volume.structures = {{"low", box_mask(volume.grid.size, {0, 0, 0}, {1, 2, 2})},
                       {"high", box_mask(volume.grid.size, {2, 0, 0}, {3, 2, 2})}};
  volume.values = values;
  return make_content(volume);
}

TEST(MaskedVolume, HoldsTheSelectedVoxelsAndNothingElse) {
  std::vector<std::uint8_t> greys(36);
  for (std::size_t n = 0; n < greys.size(); ++n) greys[n] = static_cast<std::uint8_t>(n + 1);
  const AtlasContent content = two_halves(make_values(VoxelType::kUInt8, greys));
  const auto masked = value_or_throw(masked_volume(content, selection_of("high", content.graph)));
  ASSERT_EQ(masked.grid, storage_grid(content));
  for (std::int64_t k = 0; k < 3; ++k) {
    for (std::int64_t j = 0; j < 3; ++j) {
      for (std::int64_t i = 0; i < 4; ++i) {
        EXPECT_EQ(masked.at(i, j, k), i >= 2 ? (k * 3 + j) * 4 + i + 1 : 0);
      }
    }
  }
  EXPECT_EQ(masked.at(4, 0, 0), 0);
  EXPECT_EQ(masked.at(-1, 0, 0), 0);
  const auto surfaces = value_or_throw(masked_volume(content, selection_of("high:surface", content.graph)));
  EXPECT_THAT(surfaces.greys, testing::Each(0));
}

/// "high" has 2 x 3 x 3 voxels, all on its boundary. Its normals come in the order of its voxels.
TEST(MaskedVolume, HoldsTheNormalsOfSelectedBoundaryVoxels) {
  const AtlasContent content = two_halves(make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(36, 9)));
  const auto masked = value_or_throw(masked_volume(content, selection_of("high", content.graph)));
  ASSERT_EQ(masked.normals.size(), masked.greys.size());
  std::size_t met = 0;
  for (std::size_t n = 0; n < masked.normals.size(); ++n) {
    if (n % 4 < 2) {
      EXPECT_EQ(masked.normals[n], MaskedVolume::kOutside);
    } else {
      EXPECT_EQ(masked.normals[n], content.boundary_normals[content.class_volume[n]][met++]);
    }
  }
  EXPECT_EQ(met, 18);
}

TEST(MaskedVolume, NeedsGreyValuesOf8Bits) {
  const AtlasContent content = two_halves(make_values(VoxelType::kInt16, std::vector<std::int16_t>(36, 5)));
  EXPECT_FALSE(masked_volume(content, selection_of("high", content.graph)));
}

TEST(GreyAppearance, IsLinearBetweenKnotsAndConstantBeyond) {
  const GreyAppearance appearance{
      {{10, 0, {0, 0, 0}}, {20, 1, {1, 0.5, 0}}, {20, 3, {1, 1, 1}}, {30, 4, {0, 0, 1}}}};
  EXPECT_EQ(appearance.at(-5).extinction_per_mm, 0);
  EXPECT_DOUBLE_EQ(appearance.at(15).extinction_per_mm, 0.5);
  EXPECT_DOUBLE_EQ(appearance.at(15).color[1], 0.25);
  EXPECT_EQ(appearance.at(20).extinction_per_mm, 3);
  EXPECT_DOUBLE_EQ(appearance.at(25).extinction_per_mm, 3.5);
  EXPECT_EQ(appearance.at(99).extinction_per_mm, 4);
}

TEST(GreyAppearance, IsTheTransferFunctionInExtinctions) {
  StructureDraw draw{.mode = DrawMode::kVolume, .opacity = 0.5f, .color = {255, 255, 255}};
  const Display display{.window_low = 40, .window_high = 140};
  const auto soft = value_or_throw(grey_appearance(draw, display, 2.0));
  EXPECT_EQ(soft.at(40).extinction_per_mm, 0);
  EXPECT_DOUBLE_EQ(soft.at(90).extinction_per_mm, 0.5 * std::log(2.0) / 2);
  EXPECT_DOUBLE_EQ(soft.at(90).color[2], 0.25 + 0.75 * 0.5);
  EXPECT_DOUBLE_EQ(soft.at(255).extinction_per_mm, std::log(2.0) / 2);
  draw.volume.profile = TransferProfile::kHard;
  const auto hard = value_or_throw(grey_appearance(draw, display, 2.0));
  EXPECT_EQ(hard.at(89).extinction_per_mm, 0);
  EXPECT_DOUBLE_EQ(hard.at(91).extinction_per_mm, std::log(2.0) / 2);
}

}  // namespace
}  // namespace splatlas::reference
