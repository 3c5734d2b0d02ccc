#include <gtest/gtest.h>

#include "player/render/rays/volume/ray_volume.h"
#include "tests/player/mean_field.h"
#include "tests/player/prepared_selection.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// Optical properties of a pre-classified volume, by voxel of its grid.
std::vector<reference::VoxelOptics> unpacked(const RayVolume& volume, const Grid& grid) {
  std::vector<reference::VoxelOptics> voxels(static_cast<std::size_t>(grid.voxels()));
  if (volume.empty()) return voxels;
  const std::array<std::int32_t, 3>& size = volume.grid().size;
  const float* optics = volume.sources().front().optics;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i, optics += 4) {
        if (optics[0] == 0) continue;
        const auto& first = volume.first();
        reference::VoxelOptics& voxel =
            voxels.at(static_cast<std::size_t>(grid.offset(i + first[0], j + first[1], k + first[2])));
        voxel.extinction = optics[0];
        for (std::size_t c = 0; c < 3; ++c) voxel.emission[c] = optics[c + 1];
      }
    }
  }
  return voxels;
}

TEST(RayMeans, AreTheMeansOfTheirVoxels) {
  std::uint64_t compared = 0;
  for (std::uint32_t number = 0; number < 30; ++number) {
    const RandomScene scene = random_scene(number, 20);
    const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
    PreparedSelection prepared(scene.content, scene.selection, 2);
    const Grid& grid = prepared.atlas->grid();
    const reference::OpticalField field =
        reference::optical_field(scene.content, scene.selection, view, false);
    RayVolume voxels = prepared.rays(Classification::kBefore, true);
    voxels.light(view, Lighting(view), prepared.pool);  // means are of unlit voxels
    for (const int level : {1, 2, 3}) {
      const RayVolume means = *voxels.means(prepared.runs(Axis::kZ), level, prepared.pool);
      compared += means.voxels();
      const Grid coarse = coarse_grid(grid, level);
      expect_near(unpacked(means, coarse), means_of(field, grid, level), 1e-5);
      std::uint64_t blocks = 0;
      for (const reference::VoxelOptics& block : means_of(field, grid, level)) blocks += block.extinction > 0;
      EXPECT_EQ(means.voxels(), blocks);
    }
  }
  EXPECT_GT(compared, 2000u);
}

TEST(RayMeans, LightTheSharesOfBoundaryVoxels) {
  const TestVolume volume = slab();
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("slab:volume(color=#ff8040)", content.graph));
  const ParallelView view =
      *parallel_view({.azimuth_deg = 35, .elevation_deg = 50}, {64, 64}, content.display);
  const std::vector<reference::VoxelOptics> expected =
      means_of(reference::optical_field(content, prepared.selection, view, true), volume.grid, 1);
  RayVolume means =
      *prepared.rays(Classification::kBefore, true).means(prepared.runs(Axis::kZ), 1, prepared.pool);
  means.light(view, Lighting(view), prepared.pool);
  expect_lit(unpacked(means, coarse_grid(volume.grid, 1)), expected);
}

/// Fog of one density has the same picture on every level, with or without a wall in it.
TEST(RayMeans, LateDraftsInPerspectiveShowThem) {
  TestVolume volume;
  volume.grid.size = {32, 32, 32};
  volume.structures = {{"block", box_mask(volume.grid.size, {8, 8, 8}, {23, 23, 23})},
                       {"wall", box_mask(volume.grid.size, {4, 18, 4}, {27, 19, 27}), {0, 0, 255}}};
  const AtlasContent content = make_content(volume);
  for (const char* const text : {"block:volume(opacity=0.02)", "block:volume(opacity=0.02) + wall:surface"}) {
    SCOPED_TRACE(text);
    Renderer renderer(open_in_memory(content));
    ASSERT_TRUE(renderer.select(selection_of(text, content.graph)));
    const Camera camera{.azimuth_deg = 30, .elevation_deg = 20, .projection = CameraProjection::kPerspective};
    RenderOptions options{.size = {48, 48}, .quality = Quality::kDraft, .hybrid_shading = false};
    const Frame exact = *renderer.render(camera, options);
    EXPECT_EQ(exact.stats.level, 0);
    options.draft_budget_ms = 1e-6;
    ASSERT_TRUE(renderer.render(camera, options));  // late
    const Frame coarse = *renderer.render(camera, options);
    EXPECT_EQ(coarse.stats.level, 2);
    EXPECT_EQ(coarse.stats.voxels_visited, 4u * 4 * 4);
    const std::size_t middle = 4 * (24 * 48 + 24);
    for (std::size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(coarse.picture.rgba[middle + c], exact.picture.rgba[middle + c], 3e-3) << c;
    EXPECT_TRUE(coarse.picker(24, 24, coarse.ids)) << "the voxels can be picked";
    options.quality = Quality::kNormal;
    EXPECT_EQ(renderer.render(camera, options)->stats.level, 0);
  }
}

}  // namespace
}  // namespace splatlas
