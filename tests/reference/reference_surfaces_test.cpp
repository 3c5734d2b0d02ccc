#include "tests/reference/reference_surfaces.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "player/view/shear.h"
#include "tests/reference/ray.h"
#include "tests/support/test_content.h"

namespace splatlas::reference {
namespace {

constexpr Matrix3 kStraight{1, 0, 0, 0, 1, 0, 0, 0, 1};

/// A ball with a translucent surface.
struct BallScene {
  AtlasContent content;
  Selection selection;

  BallScene() {
    TestVolume volume;
    volume.grid = {{17, 17, 17}, {1, 2, 0.5}, {3, -4, 5}, kStraight};
    volume.structures = {{"ball", make_mask(volume.grid.size, [](auto i, auto j, auto k) {
                            return (i - 8) * (i - 8) + (j - 8) * (j - 8) + (k - 8) * (k - 8) < 50;
                          })}};
    content = make_content(volume);
    selection = selection_of("ball:surface(opacity=0.5)", content.graph);
  }
};

/// Ray-triangle intersection (Moeller and Trumbore 1997), in voxel indices.
std::vector<double> crossings_of_ray(const SurfaceMesh& mesh, const Ray& ray) {
  std::vector<double> found;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 3> p{};
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& position = mesh.positions_ijk[triangle[n]];
      p[n] = {position[0], position[1], position[2]};
    }
    const Vec3 edge1 = minus(p[1], p[0]);
    const Vec3 edge2 = minus(p[2], p[0]);
    const Vec3 across = cross(ray.per_mm, edge2);
    const double determinant = dot(edge1, across);
    if (determinant == 0) continue;
    const Vec3 from = minus(ray.start, p[0]);
    const double u = dot(from, across) / determinant;
    const Vec3 q = cross(from, edge1);
    const double v = dot(ray.per_mm, q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) found.push_back(dot(edge2, q) / determinant);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(ReferenceSurfaces, EqualMoellerAndTrumbore) {
  const BallScene scene;
  int crossed = 0;
  for (int direction = 0; direction < 6; ++direction) {
    Camera camera;
    camera.azimuth_deg = 31.3 * direction;
    camera.elevation_deg = 77.7 - 13.1 * direction;
    camera.center_lps_mm = scene.content.display.center_lps_mm;
    for (double& mm : *camera.center_lps_mm) mm += 0.0123 + 0.0071 * direction;  // no ray through an edge
    const ParallelView view = *parallel_view(camera, {23, 19}, scene.content.display);
    const Shear shear = factorise(view, scene.content.source_grid);
    const SurfacesInView surfaces(scene.content, scene.selection, view, shear.principal, Coverage::kExact);
    for (int row = 0; row < 19; ++row) {
      for (int column = 0; column < 23; ++column) {
        const auto crossings = surfaces.crossings(column + 0.5, row + 0.5);
        const Ray ray = ray_through(view, scene.content.source_grid, column + 0.5, row + 0.5);
        const auto expected = crossings_of_ray(scene.content.surfaces[0], ray);
        ASSERT_EQ(crossings.size(), expected.size()) << "direction " << direction;
        for (std::size_t n = 0; n < crossings.size(); ++n) {
          ASSERT_NEAR(crossings[n].s_mm, expected[n], 1e-9);
          const double index = ray.at(expected[n])[shear.scan.slice_axis];
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
