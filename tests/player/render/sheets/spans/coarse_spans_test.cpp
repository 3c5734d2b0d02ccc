#include "player/render/sheets/spans/coarse_spans.h"

#include <limits>

#include <gtest/gtest.h>

#include "player/render/light/voxel_light.h"
#include "tests/player/mean_field.h"
#include "tests/player/prepared_selection.h"
#include "tests/player/render/sheets/spans/unpacked_spans.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

TEST(CoarseSpans, AreTheMeansOfTheirVoxels) {
  std::uint64_t compared = 0;
  for (std::uint32_t number = 0; number < 30; ++number) {
    const RandomScene scene = random_scene(number, 20);
    const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
    PreparedSelection prepared(scene.content, scene.selection, 2);
    const Grid& grid = prepared.atlas->grid();
    const reference::OpticalField field =
        reference::optical_field(scene.content, scene.selection, view, false);
    for (const Axis axis : kAxes) {
      for (const int level : {1, 2, 3}) {
        const CoarseSpans spans(prepared.spans(axis), true, level, prepared.pool);
        compared += spans.model().voxels;
        const std::vector<reference::VoxelOptics> expected = means_of(field, grid, level);
        expect_near(unpacked(spans.model(), coarse_grid(grid, level)), expected, 1e-5);
      }
    }
  }
  EXPECT_GT(compared, 5000u);
}

TEST(CoarseSpans, LightTheSharesOfBoundaryVoxels) {
  const TestVolume volume = slab();
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("slab:volume(color=#ff8040)", content.graph));
  const ParallelView view =
      *parallel_view({.azimuth_deg = 35, .elevation_deg = 50}, {64, 64}, content.display);
  const reference::OpticalField field = reference::optical_field(content, prepared.selection, view, true);
  const std::vector<reference::VoxelOptics> expected = means_of(field, volume.grid, 1);
  for (const Axis axis : kAxes) {
    const CoarseSpans spans(prepared.spans(axis), true, 1, prepared.pool);
    const Grid coarse = coarse_grid(volume.grid, 1);
    expect_lit(unpacked(spans.model(), coarse, Lighting(view).table()), expected);
  }
}

TEST(VoxelSums, HaveAColourForTheSmallestEmissions) {
  const float least = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ((VoxelSums{.emission = {least, 0, least}, .weight = least}.color()),
            (std::array<float, 3>{1, 0, 1}));
}

TEST(CoarseGrid, CoversTheGridFromItsCorner) {
  const Grid grid{{7, 8, 9}, {1, 2, 3}, {10, 20, 30}, {0, 1, 0, -1, 0, 0, 0, 0, 1}};
  const Grid coarse = coarse_grid(grid, 2);
  EXPECT_EQ(coarse.size, (Index3{2, 2, 3}));
  EXPECT_EQ(coarse.spacing_mm, (Vec3{4, 8, 12}));
  const Vec3 corner = index_to_lps_mm(grid).apply({-0.5, -0.5, -0.5});
  const Vec3 of_coarse = index_to_lps_mm(coarse).apply({-0.5, -0.5, -0.5});
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(of_coarse[a], corner[a], 1e-12);
}

}  // namespace
}  // namespace splatlas
