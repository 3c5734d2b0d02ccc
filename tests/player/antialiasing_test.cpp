// Antialiased edges of surfaces: coverage, and the cost of samples. Random scenes compare pictures with the
// model.
#include <gtest/gtest.h>

#include "player/render/surfaces/rasterize.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// An edge moves across a pixel in steps of 1/16. The pixel follows its coverage to 1/8.
TEST(Antialiasing, FollowsTheCoveredShareOfAPixel) {
  SurfaceMesh mesh;
  mesh.normals_lps.assign(3, {0, -1, 0});
  mesh.triangles = {{0, 1, 2}};
  const Grid grid{{16, 16, 16}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const Camera camera{.center_lps_mm = Vec3{0, 0, 0}};
  ParallelView view = *parallel_view(camera, {8, 8}, Display{});
  view.mm_per_pixel = 1;
  ThreadPool pool(1);
  const Lighting lighting(view);
  for (int step = 0; step <= 16; ++step) {
    const float right = static_cast<float>(step) / 16;  // edge of the triangle, mm right of the middle
    mesh.positions_ijk = {{right, 0, -50}, {right, 0, 50}, {right - 60, 0, 0}};
    const SurfaceClusters clusters(mesh, grid);
    const SurfaceDraw surface{&mesh, &clusters, 0, {1, 1, 1}, 0.5f};
    FragmentList list;
    const RasterScene scene = raster_scene({&surface, 1}, view, factorise(view, grid), grid, lighting);
    ASSERT_TRUE(Rasterizer().draw(scene, {.edge_samples = 8}, list, pool));
    double covered = 0;
    int samples = 0;
    for (std::size_t n = 0; n < list.sample_count(); ++n) {
      if (list.samples[n].pixel != 4 * 8 + 4) continue;
      covered += static_cast<double>(list.of_sample(n).size());
      ++samples;
    }
    ASSERT_EQ(samples, 8) << step;
    EXPECT_NEAR(covered / samples, right, 1.0 / 8) << step;
  }
}

}  // namespace
}  // namespace splatlas
