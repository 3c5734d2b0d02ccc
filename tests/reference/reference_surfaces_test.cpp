#include "tests/reference/reference_surfaces.h"

#include <gtest/gtest.h>

#include "player/render/view/shear.h"
#include "tests/reference/ray_surfaces.h"
#include "tests/support/test_content.h"

namespace splatlas::reference {
namespace {

/// A ball with a translucent surface.
struct BallScene {
  AtlasContent content;
  Selection selection;

  BallScene() {
    TestVolume volume;
    volume.grid = {.size = {17, 17, 17}, .spacing_mm = {1, 2, 0.5}, .origin_lps_mm = {3, -4, 5}};
    volume.structures = {{"ball", ball_mask(volume.grid.size, {8, 8, 8}, 50)}};
    content = make_content(volume);
    selection = selection_of("ball:surface(opacity=0.5)", content.graph);
  }
};

TEST(ReferenceSurfaces, EqualMoellerAndTrumbore) {
  const BallScene scene;
  int crossed = 0;
  for (int direction = 0; direction < 6; ++direction) {
    Camera camera{.azimuth_deg = 31.3 * direction,
                  .elevation_deg = 77.7 - 13.1 * direction,
                  .center_lps_mm = scene.content.display.center_lps_mm};
    for (double& mm : *camera.center_lps_mm) mm += 0.0123 + 0.0071 * direction;  // no ray through an edge
    const ParallelView view = *parallel_view(camera, {23, 19}, scene.content.display);
    const Shear shear = factorise(view, scene.content.source_grid);
    const SurfacesInView surfaces(scene.content, scene.selection, view, shear.principal, Coverage::kExact);
    const RaySurfaces along_rays(scene.content, scene.selection, {view});
    for (int row = 0; row < 19; ++row) {
      for (int column = 0; column < 23; ++column) {
        const auto crossings = surfaces.crossings(column + 0.5, row + 0.5);
        const Ray ray = ray_through(view, scene.content.source_grid, column + 0.5, row + 0.5);
        const std::vector<Crossing> expected = along_rays.crossings(ray, kWholeRay);
        ASSERT_EQ(crossings.size(), expected.size()) << "direction " << direction;
        for (std::size_t n = 0; n < crossings.size(); ++n) {
          ASSERT_NEAR(crossings[n].s_mm, expected[n].s_mm, 1e-9);
          const double index = ray.at(expected[n].s_mm)[shear.scan.slice_axis];
          ASSERT_NEAR(crossings[n].depth, shear.ascending ? index : -index, 1e-9);
        }
        ASSERT_EQ(crossings.size() % 2, 0u) << "a closed surface";
        crossed += crossings.empty() ? 0 : 1;
      }
    }
  }
  EXPECT_GT(crossed, 300);
}

TEST(ReferenceSurfaces, EndAtTheFirstOpaqueOne) {
  BallScene scene;
  scene.selection.structures[0].opacity = 1.0f;
  const ParallelView view = *parallel_view({}, {9, 9}, scene.content.display);
  const SurfacesInView surfaces(scene.content, scene.selection, view, Axis::kY, Coverage::kSnapped);
  const auto crossings = surfaces.crossings(4.5, 4.5);
  ASSERT_EQ(crossings.size(), 1u);
  EXPECT_TRUE(crossings[0].entering);
  EXPECT_NEAR(crossings[0].depth, 0.5, 0.51);  // the near side: the ball begins at voxel 1
}

}  // namespace
}  // namespace splatlas::reference
