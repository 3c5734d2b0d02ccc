// Perspective surfaces: projection, near plane, guard band, perspective-correct attributes.
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "player/render/surfaces/rasterize.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas {
namespace {

using reference::minus;

constexpr Grid kGrid{{16, 16, 16}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

reference::PerspectiveView view_from(double azimuth_deg, double elevation_deg, double mm_per_pixel,
                                     double fov_deg) {
  const Camera camera{
      .azimuth_deg = azimuth_deg, .elevation_deg = elevation_deg, .center_lps_mm = Vec3{8, 8, 8}};
  reference::PerspectiveView view{*parallel_view(camera, {40, 30}, Display{}), fov_deg};
  view.in_plane.mm_per_pixel = mm_per_pixel;
  return view;
}

FragmentList draw(const SurfaceMesh& mesh, const reference::PerspectiveView& view, float opacity = 0.5f) {
  const SurfaceClusters clusters(mesh, kGrid);
  const SurfaceDraw surface{&mesh, &clusters, 3, {0.9f, 0.6f, 0.3f}, opacity};
  const Lighting lighting(view.in_plane);
  RasterScene scene =
      raster_scene({&surface, 1}, view.in_plane, factorise(view.in_plane, kGrid), kGrid, lighting);
  scene.projection = Projection(view.in_plane, kGrid, view.distance_mm());
  ThreadPool pool(1);
  FragmentList list;
  EXPECT_TRUE(Rasterizer().draw(scene, {}, list, pool));
  return list;
}

/// Intersection of the ray through picture coordinates (x, y) with a triangle (grid: voxels are LPS mm).
struct Hit {
  Vec3 at{};
  std::array<double, 3> weights{};
  double w = 0;  ///< depth along the view direction, over the distance of the centre
};
std::optional<Hit> hit(const SurfaceMesh& mesh, const reference::PerspectiveView& view, double x, double y) {
  const reference::Ray ray = ray_through(view, kGrid, x, y);
  std::array<Vec3, 3> p{};
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t a = 0; a < 3; ++a) p[n][a] = mesh.positions_ijk[mesh.triangles[0][n]][a];
  }
  const Vec3 normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
  const double s = dot(minus(p[0], ray.start), normal) / dot(ray.per_mm, normal);
  Hit found;
  found.at = ray.at(s);
  found.w = dot(minus(found.at, view.eye_lps_mm()), view.in_plane.forward_lps) / view.distance_mm();
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 edge = minus(p[(n + 2) % 3], p[(n + 1) % 3]);
    found.weights[n] = dot(cross(edge, minus(found.at, p[(n + 1) % 3])), normal) / dot(normal, normal);
    if (found.weights[n] < 0) return std::nullopt;
  }
  return found.w >= kNearPlane ? std::optional(found) : std::nullopt;
}

TEST(PerspectiveSurfaces, PointsAreSeenWhereTheirRaysPassThroughThePicture) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-20, 36);
  for (const double fov : {5.0, 30.0, 120.0}) {
    const auto view = view_from(25, -40, 0.5, fov);
    const Projection projection(view.in_plane, kGrid, view.distance_mm());
    int seen = 0;
    for (int n = 0; n < 200; ++n) {
      const std::array<float, 3> p{place(random), place(random), place(random)};
      if (projection.homogeneous(p).w < 0.01) continue;
      const ScreenPoint point = projection.on_screen(p);
      const reference::Ray ray = ray_through(view, kGrid, point.x + 0.5, point.y + 0.5);
      const Vec3 from_eye = minus({p[0], p[1], p[2]}, ray.start);
      const Vec3 off = minus(from_eye, minus(ray.at(dot(from_eye, ray.per_mm)), ray.start));
      EXPECT_LT(std::sqrt(dot(off, off)), 1e-9);
      EXPECT_NEAR(point.w, dot(from_eye, view.in_plane.forward_lps) / view.distance_mm(), 1e-12);
      ++seen;
    }
    EXPECT_GT(seen, 50);
  }
}

/// Triangles around the eye, many of which reach behind it, against rays.
TEST(PerspectiveSurfaces, EqualRaysThroughSinglePixelsAlsoAcrossTheNearPlane) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> place(-24, 40);
  std::size_t compared = 0;
  std::size_t clipped = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const auto view = view_from(7 * trial, 80 - 1.3 * trial, 0.4, 20 + trial % 3 * 40);
    SurfaceMesh mesh;
    bool behind = false;
    const Projection projection(view.in_plane, kGrid, view.distance_mm());
    for (int n = 0; n < 3; ++n) {
      mesh.positions_ijk.push_back({place(random), place(random), place(random)});
      mesh.normals_lps.push_back({0, 0, 0});
      mesh.normals_lps.back()[static_cast<std::size_t>(n)] = 1;
      behind |= projection.homogeneous(mesh.positions_ijk.back()).w < kNearPlane;
    }
    mesh.triangles = {{0, 1, 2}};
    const FragmentList list = draw(mesh, view);
    std::map<std::uint32_t, Fragment> drawn;
    for (std::size_t n = 0; n < list.sample_count(); ++n) {
      ASSERT_EQ(list.of_sample(n).size(), 1u) << "a pixel is covered twice";
      drawn[list.samples[n].pixel] = list.of_sample(n)[0];
    }
    const Shear shear = factorise(view.in_plane, kGrid);
    for (std::uint32_t pixel = 0; pixel < 40 * 30; ++pixel) {
      const double x = pixel % 40 + 0.5;
      const double y = pixel / 40 + 0.5;
      const auto at_center = hit(mesh, view, x, y);
      bool near_border = false;  // vertices are rounded to 1/256 pixel
      for (const double d : {-0.02, 0.02}) {
        near_border |= hit(mesh, view, x + d, y).has_value() != at_center.has_value() ||
                       hit(mesh, view, x, y + d).has_value() != at_center.has_value();
      }
      if (near_border) continue;
      ASSERT_EQ(drawn.contains(pixel), at_center.has_value()) << "trial " << trial << ", pixel " << pixel;
      if (!at_center) continue;
      const double depth = (shear.ascending ? 1 : -1) * at_center->at[shear.scan.slice_axis];
      EXPECT_NEAR(drawn[pixel].depth, depth, 2e-5) << "trial " << trial;
      ++compared;
      clipped += behind ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 15000u);
  EXPECT_GT(clipped, 5000u);
}

/// On a slanted plane, the midpoint is not the midpoint in the picture.
TEST(PerspectiveSurfaces, InterpolatesNormalsOverTheTriangleNotOverThePicture) {
  SurfaceMesh mesh;
  mesh.positions_ijk = {{-20, -2, 4}, {36, -2, 4}, {8, 80, 4}};
  mesh.normals_lps = {{0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f}, {0, -0.6f, 0.8f}};
  mesh.triangles = {{0, 1, 2}};
  const auto view = view_from(0, 25, 0.4, 70);
  for (const float opacity : {0.5f, 1.0f}) {
    const FragmentList list = draw(mesh, view, opacity);
    ASSERT_GT(list.sample_count(), 300u);
    for (std::size_t n = 0; n < list.sample_count(); ++n) {
      const std::uint32_t pixel = list.samples[n].pixel;
      const auto found = hit(mesh, view, pixel % 40 + 0.5, pixel / 40 + 0.5);
      if (!found) continue;
      Vec3 normal{};
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t a = 0; a < 3; ++a) {
          normal[a] += found->weights[c] * static_cast<double>(mesh.normals_lps[c][a]);
        }
      }
      const auto expected = reference::shade_surface(view.in_plane, {0.9, 0.6, 0.3}, normal);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(list.of_sample(n)[0].rgba[c], opacity * expected[c], 2e-3) << "pixel " << pixel;
      }
    }
  }
}

/// Vertices millions of pixels away: the picture lies inside the triangle, or across one of its edges.
TEST(PerspectiveSurfaces, TrianglesBeyondTheGuardBandAreCutNotLost) {
  const Camera camera{.center_lps_mm = Vec3{8, 8, 8}};
  ParallelView view = *parallel_view(camera, {16, 12}, Display{});
  view.mm_per_pixel = 1e-6;
  SurfaceMesh mesh;
  mesh.positions_ijk = {{0, 5, 8}, {16, 5, 8}, {8, 5, 16}};  // its lower edge crosses the centre
  mesh.normals_lps.assign(3, {0, -1, 0});
  mesh.triangles = {{0, 1, 2}};
  const SurfaceClusters clusters(mesh, kGrid);
  const SurfaceDraw surface{&mesh, &clusters, 0, {1, 1, 1}, 0.5f};
  const Lighting lighting(view);
  ThreadPool pool(1);
  FragmentList list;
  const RasterScene scene = raster_scene({&surface, 1}, view, factorise(view, kGrid), kGrid, lighting);
  ASSERT_TRUE(Rasterizer().draw(scene, {}, list, pool));
  ASSERT_EQ(list.sample_count(), 16u * 6u);
  for (std::uint32_t n = 0; n < 16 * 6; ++n) {
    EXPECT_EQ(list.samples[n].pixel, n);
    EXPECT_NEAR(list.of_sample(n)[0].depth, 5, 1e-6);
  }
}

}  // namespace
}  // namespace splatlas
