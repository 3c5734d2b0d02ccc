#include "player/transfer/volume_looks.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/reference/reference_light.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// One voxel after another, each a structure of its own.
AtlasContent row_of(std::size_t structures) {
  TestVolume volume;
  volume.grid.size = {static_cast<std::int64_t>(structures), 1, 1};
  std::vector<std::int16_t> values;
  for (std::size_t s = 0; s < structures; ++s) {
    std::vector<bool> mask(structures, false);
    mask[s] = true;
    volume.structures.push_back({fmt::format("s{}", s), std::move(mask)});
    values.push_back(static_cast<std::int16_t>(static_cast<int>(s) - 20));
  }
  volume.values = make_values(VoxelType::kInt16, values);
  volume.window_low = -20;
  volume.window_high = 80;
  return make_content(volume);
}

/// The look of every structure's voxel, by structure.
std::vector<VoxelLook> look_at(const AtlasContent& content, const DrawPlan& plan,
                               std::span<const VolumeLook> looks) {
  std::vector<VoxelLook> voxels(content.graph.size());
  for (std::size_t n = 0; n < plan.classes.size(); ++n) {
    const StructureIndex s = plan.classes[n].volume_of;
    looks[n].look_up(content.values.bytes.data(), s, 1, 1, &voxels[s]);
  }
  return voxels;
}

TEST(VolumeLooks, GiveEveryStructureItsOwnTransferFunction) {
  const AtlasContent content = row_of(6);
  const auto atlas = open_in_memory(content);
  VolumeLooks looks(*atlas);
  const Selection selection = selection_of(
      "s0 + s1(opacity=0.5) + s2(low=-19,high=-17) + s3(profile=hard,low=-18,high=-17) + "
      "s4(curve=-16:0.5:0.5) + s5(curve=-16:0.5/-14:0)",
      content.graph);
  const DrawPlan plan = atlas->tree().plan(selection);
  looks.select(plan, selection);
  const std::vector<VoxelLook> voxels = look_at(content, plan, looks.looks());
  const double ln2 = std::log(2.0);
  EXPECT_EQ(voxels[0].extinction_per_mm, 0);  // at the window's low end
  EXPECT_NEAR(voxels[1].extinction_per_mm, 0.01 * ln2, 1e-8);
  EXPECT_NEAR(voxels[1].shade, 0.2575, 1e-7);
  EXPECT_NEAR(voxels[2].extinction_per_mm, 0.5 * -std::log(0.7), 1e-7);
  EXPECT_NEAR(voxels[3].extinction_per_mm, -std::log(0.05), 2e-6);
  EXPECT_NEAR(voxels[4].extinction_per_mm, ln2, 1e-7);
  EXPECT_EQ(voxels[4].shade, 0.5f);
  EXPECT_NEAR(voxels[5].extinction_per_mm, 0.5 * ln2, 1e-7);
}

TEST(VolumeLooks, HoldForMoreTransferFunctionsThanTables) {
  const std::size_t count = 100;
  const AtlasContent content = row_of(count);
  const auto atlas = open_in_memory(content);
  VolumeLooks looks(*atlas);
  for (const int shift : {0, 7, 0, 50}) {
    Selection selection = selection_of("*", content.graph);
    for (std::size_t s = 0; s < count; ++s) {
      selection.structures[s].volume.low = static_cast<double>(s) - 21.0 - shift;
      selection.structures[s].volume.high = static_cast<double>(s) - 19.0;
    }
    const DrawPlan plan = atlas->tree().plan(selection);
    looks.select(plan, selection);
    for (const VoxelLook& look : look_at(content, plan, looks.looks())) {
      const double t = (1.0 + shift) / (2.0 + shift);
      EXPECT_NEAR(look.extinction_per_mm, -t * std::log(0.7), 1e-7) << shift;
      EXPECT_NEAR(look.shade, 0.25 + 0.75 * t, 1e-7) << shift;
    }
    // What they are without words did not get lost.
    const Selection plain = selection_of("*", content.graph);
    looks.select(plan, plain);
    const std::vector<VoxelLook> voxels = look_at(content, plan, looks.looks());
    for (std::size_t s = 0; s < count; ++s) {
      EXPECT_NEAR(voxels[s].extinction_per_mm, static_cast<double>(s) / 100 * -std::log(0.7), 1e-7);
    }
  }
}

TEST(VolumeLooks, ShareOneTableAmongOpacities) {
  const AtlasContent content = row_of(3);
  const auto atlas = open_in_memory(content);
  VolumeLooks looks(*atlas);
  const Selection selection = selection_of("s0 + s1(opacity=0.9) + s2(profile=thin)", content.graph);
  const DrawPlan plan = atlas->tree().plan(selection);
  looks.select(plan, selection);
  for (const VolumeLook& look : looks.looks()) EXPECT_EQ(look.transfer, looks.looks()[0].transfer);
}

TEST(VolumeLooks, ReachTheirOpacityOverTheReferenceLength) {
  for (const double spacing_mm : {1e-6, 0.7, 1e6}) {
    AtlasContent content = row_of(1);
    content.source_grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
    const auto atlas = open_in_memory(content);
    VolumeLooks looks(*atlas);
    for (const float opacity : {1e-8f, 1e-4f, 0.1f, 0.5f, 0.999f}) {
      Selection selection = selection_of("s0", content.graph);
      selection.structures[0].opacity = opacity;
      const DrawPlan plan = atlas->tree().plan(selection);
      looks.select(plan, selection);
      const double depth = looks.looks()[0].extinction_per_mm * atlas->reference_length_mm();
      // The float extinction rounds the depth by 6e-8 of itself.
      EXPECT_NEAR(-std::expm1(-depth) / static_cast<double>(opacity), 1, 2e-7)
          << opacity << ", " << spacing_mm;
    }
  }
}

TEST(VolumeLooks, ColorsAreLinearLight) {
  const AtlasContent content = row_of(1);
  const auto atlas = open_in_memory(content);
  VolumeLooks looks(*atlas);
  Selection selection = selection_of("s0", content.graph);
  const DrawPlan plan = atlas->tree().plan(selection);
  for (int channel = 0; channel < 256; ++channel) {
    selection.structures[0].color = {static_cast<std::uint8_t>(channel), 0, 255};
    looks.select(plan, selection);
    const VolumeLook& look = looks.looks()[0];
    EXPECT_NEAR(look.color[0], reference::linear_of(selection.structures[0].color)[0], 1e-7);
    EXPECT_EQ(look.color[1], 0.0f);
    EXPECT_EQ(look.color[2], 1.0f);
    const std::array<float, 3> emission = look.emission({2.0f, 0.25f});
    EXPECT_FLOAT_EQ(emission[0], 0.5f * look.color[0]);
    EXPECT_EQ(emission[2], 0.5f);
  }
}

}  // namespace
}  // namespace splatlas
