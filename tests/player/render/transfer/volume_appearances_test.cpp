#include "player/render/transfer/volume_appearances.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/player/prepared_selection.h"

namespace splatlas {
namespace {

/// A row of voxels, each its own structure.
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

/// Classified voxel of every structure.
std::vector<ClassifiedVoxel> classified_voxels(const AtlasContent& content, PreparedSelection& prepared) {
  std::vector<ClassifiedVoxel> voxels(content.graph.size());
  for (std::size_t n = 0; n < prepared.plan.classes.size(); ++n) {
    const StructureIndex s = prepared.plan.classes[n].volume_of;
    prepared.appearances.appearances()[n].look_up(content.values.bytes.data(), s, 1, 1, &voxels[s]);
  }
  return voxels;
}

TEST(VolumeAppearances, GiveEveryStructureItsOwnTransferFunction) {
  const AtlasContent content = row_of(6);
  const Selection selection = selection_of(
      "s0 + s1(opacity=0.5) + s2(low=-19,high=-17) + s3(profile=hard,low=-18,high=-17) + "
      "s4(curve=-16:0.5:0.5) + s5(curve=-16:0.5/-14:0)",
      content.graph);
  PreparedSelection prepared(content, selection);
  const std::vector<ClassifiedVoxel> voxels = classified_voxels(content, prepared);
  const double ln2 = std::log(2.0);
  EXPECT_EQ(voxels[0].extinction_per_mm, 0);  // at the low end of the window
  EXPECT_NEAR(voxels[1].extinction_per_mm, 0.01 * ln2, 1e-8);
  EXPECT_NEAR(voxels[1].shade, 0.2575, 1e-7);
  EXPECT_NEAR(voxels[2].extinction_per_mm, 0.5 * -std::log(0.7), 1e-7);
  EXPECT_NEAR(voxels[3].extinction_per_mm, -std::log(0.05), 2e-6);
  EXPECT_NEAR(voxels[4].extinction_per_mm, ln2, 1e-7);
  EXPECT_EQ(voxels[4].shade, 0.5f);
  EXPECT_NEAR(voxels[5].extinction_per_mm, 0.5 * ln2, 1e-7);
}

TEST(VolumeAppearances, HoldForMoreTransferFunctionsThanTables) {
  const std::size_t count = 100;
  const AtlasContent content = row_of(count);
  const Selection plain = selection_of("*", content.graph);
  PreparedSelection prepared(content, plain);
  for (const int shift : {0, 7, 0, 50}) {
    Selection selection = plain;
    for (std::size_t s = 0; s < count; ++s) {
      selection.structures[s].volume.low = static_cast<double>(s) - 21.0 - shift;
      selection.structures[s].volume.high = static_cast<double>(s) - 19.0;
    }
    prepared.select(selection);
    for (const ClassifiedVoxel& appearance : classified_voxels(content, prepared)) {
      const double t = (1.0 + shift) / (2.0 + shift);
      EXPECT_NEAR(appearance.extinction_per_mm, -t * std::log(0.7), 1e-7) << shift;
      EXPECT_NEAR(appearance.shade, 0.25 + 0.75 * t, 1e-7) << shift;
    }
    // Appearances without options are restored.
    prepared.select(plain);
    const std::vector<ClassifiedVoxel> voxels = classified_voxels(content, prepared);
    for (std::size_t s = 0; s < count; ++s) {
      EXPECT_NEAR(voxels[s].extinction_per_mm, static_cast<double>(s) / 100 * -std::log(0.7), 1e-7);
    }
  }
}

TEST(VolumeAppearances, ShareOneTableAmongOpacities) {
  const AtlasContent content = row_of(3);
  PreparedSelection prepared(content, selection_of("s0 + s1(opacity=0.9) + s2(profile=thin)", content.graph));
  const auto appearances = prepared.appearances.appearances();
  for (const VolumeAppearance& appearance : appearances)
    EXPECT_EQ(appearance.transfer, appearances[0].transfer);
}

}  // namespace
}  // namespace splatlas
