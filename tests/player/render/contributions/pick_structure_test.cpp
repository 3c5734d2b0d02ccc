#include "player/render/contributions/pick_structure.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "player/render/surfaces/screen_triangle.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"
#include "tests/reference/ray_surfaces.h"
#include "tests/reference/reference_surfaces.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

using Shares = std::map<StructureIndex, double>;

/// Brute-force contribution of each structure to a pixel, composited front to back: all surfaces, and the
/// nearest voxels in every plane of the ray's principal axis. In frames of rays, nothing where 0.01 pixels
/// change the crossed surfaces.
std::optional<Shares> contributions(const RandomScene& scene, const View& view, bool by_rays, double x,
                                    double y) {
  const Grid grid = storage_grid(scene.content);
  const auto ray_at = [&](double at_x, double at_y) {
    return reference::ray_through(view, scene.camera.field_of_view_deg, grid, at_x, at_y);
  };
  const reference::Ray ray = ray_at(x, y);
  std::size_t axis = 2;
  for (const std::size_t a : {1u, 0u}) {
    if (std::abs(ray.per_mm[a]) > std::abs(ray.per_mm[axis])) axis = a;
  }
  std::vector<reference::Crossing> crossings;
  if (by_rays) {
    const reference::RaySurfaces surfaces(scene.content, scene.selection, view);
    if (surfaces.near_edge(ray, ray_at(x + 0.01, y), ray_at(x, y + 0.01))) return std::nullopt;
    crossings = surfaces.crossings(ray, {view.eye_mm ? kNearPlane * *view.eye_mm : -HUGE_VAL, HUGE_VAL});
  } else {
    crossings = reference::SurfacesInView(scene.content, scene.selection, view.plane, static_cast<Axis>(axis),
                                          reference::Coverage::kSnapped)
                    .crossings(x, y);
  }
  struct Layer {
    double s_mm, opacity;
    StructureIndex structure;
  };
  std::vector<Layer> layers;
  for (const reference::Crossing& crossing : crossings)
    layers.push_back({crossing.s_mm, crossing.rgba[3], crossing.structure});
  const reference::OpticalField field =
      reference::optical_field(scene.content, scene.selection, view.plane, false);
  const DrawPlan plan = DecisionTree(scene.content.graph, scene.content.classes).plan(scene.selection);
  for (std::int64_t k = 0; k < grid.size[axis]; ++k) {
    const double s_mm = (static_cast<double>(k) - ray.start[axis]) / ray.per_mm[axis];
    if (view.eye_mm && s_mm < 0) continue;
    const Vec3 at = ray.at(s_mm);
    const Index3 voxel{std::llround(at[0]), std::llround(at[1]), std::llround(at[2])};
    if (!grid.contains(voxel[0], voxel[1], voxel[2])) continue;
    const auto n = static_cast<std::size_t>(grid.offset(voxel[0], voxel[1], voxel[2]));
    const double depth = field.voxels[n].extinction / std::abs(ray.per_mm[axis]);
    if (depth <= 0) continue;
    const auto draw = std::find_if(plan.classes.begin(), plan.classes.end(),
                                   [&](const ClassDraw& d) { return d.id == scene.content.class_volume[n]; });
    layers.push_back({s_mm, -std::expm1(-depth), draw->volume_of});
  }
  std::stable_sort(layers.begin(), layers.end(),
                   [](const Layer& a, const Layer& b) { return a.s_mm < b.s_mm; });
  Shares shares;
  double transmittance = 1;
  for (const Layer& layer : layers) {
    shares[layer.structure] += transmittance * layer.opacity;
    transmittance *= 1 - layer.opacity;
  }
  return shares;
}

/// On the ray of its pixel, in front of the eye.
void expect_on_ray(const Pick& pick, const View& view, const Grid& grid, double x, double y) {
  const Vec3 index = lps_mm_to_index(grid).apply(pick.point_lps_mm);
  const double mm =
      dot(reference::minus(pick.point_lps_mm, view.plane.center_lps_mm), view.plane.forward_lps);
  EXPECT_GE(mm, view.eye_mm ? -*view.eye_mm * (1 + 1e-9) : -HUGE_VAL);
  const Vec3 on_ray = ViewDepth(view, grid).index_at(x, y, mm);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(on_ray[a], index[a], 1e-3);
}

/// Picks in twelve pixels, one by one against the brute force.
struct Picks {
  int picked = 0, nothing = 0;

  void compare(const RandomScene& scene, bool by_rays) {
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const auto frame = render_with(renderer, scene.camera, scene.options, scene.overrides);
    if (by_rays && !frame) return;  // too wide for surfaces
    ASSERT_TRUE(frame) << frame.error().message;
    const View view = *view_of(scene.camera, scene.options.size, scene.content.display);
    for (int n = 0; n < 12; ++n) {
      const double x = (7 * n + 3) % scene.options.size.width + 0.5;
      const double y = (5 * n + 1) % scene.options.size.height + 0.5;
      const std::optional<Shares> shares = contributions(scene, view, by_rays, x, y);
      if (!shares) continue;
      double max = 0;
      for (const auto& [structure, share] : *shares) max = std::max(max, share);
      if (std::abs(max - 0.02) < 1e-4) continue;  // too close to the limit
      const auto pick = frame->pick(x, y);
      ASSERT_EQ(pick.has_value(), max >= 0.02) << "pixel at " << x << ", " << y;
      (pick ? picked : nothing) += 1;
      if (!pick) continue;
      // The maximum, or equal to it within rounding.
      ASSERT_TRUE(shares->contains(pick->structure));
      EXPECT_NEAR(shares->at(pick->structure), max, 1e-4);
      expect_on_ray(*pick, view, storage_grid(scene.content), x, y);
    }
  }
};

TEST(Pick, NamesTheStructureThatContributesMost) {
  for (const bool by_rays : {false, true}) {
    Picks picks;
    for (std::uint32_t number = 0; number < 90; ++number) {
      SCOPED_TRACE(testing::Message() << number << ", by rays: " << by_rays);
      RandomScene scene = random_scene(number);
      scene.options.antialiasing = false;  // the ray of the pixel's centre
      if (by_rays && number % 3 == 0) scene.options.classification = Classification::kAfter;
      if (by_rays && number % 3 != 0) {
        scene.camera.projection = CameraProjection::kPerspective;
        scene.camera.field_of_view_deg = number % 3 == 1 ? 20 : 50;
      }
      picks.compare(scene, by_rays);
    }
    EXPECT_GT(picks.picked, 150);
    EXPECT_GT(picks.nothing, 100);
  }
}

TEST(Pick, PointsLieOnThePixelsRayWhereTheStructureIs) {
  TestVolume volume;
  volume.grid = {{20, 20, 20}, {1.5, 1, 2}, {10, -20, 30}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  volume.structures = {{"ball", ball_mask(volume.grid.size, {10, 10, 10}, 50)}};
  const AtlasContent content = make_content(volume);
  const Affine to_index = lps_mm_to_index(storage_grid(content));
  for (const char* text : {"ball:surface", "ball:volume(opacity=1)"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const double azimuth : {0.0, 33.0, 120.0, 250.0}) {
      const Camera camera{.azimuth_deg = azimuth, .elevation_deg = 20};
      const PictureSize size{40, 40};
      const Frame frame = frame_or_throw(renderer, camera, {.size = size});
      const ParallelView view = *parallel_view(camera, size, content.display);
      for (const auto& [x, y] : {std::pair(20.5, 20.5), {20.1, 17.9}, {23.7, 22.2}}) {
        const auto pick = frame.pick(x, y);
        ASSERT_TRUE(pick);
        const Vec3 from_ray = reference::minus(pick->point_lps_mm, view.point_lps_mm(x, y));
        EXPECT_NEAR(dot(from_ray, view.right_lps), 0, 1e-9);
        EXPECT_NEAR(dot(from_ray, view.up_lps), 0, 1e-9);
        // The near side of the ball, whose surface is about 7 voxels from its centre.
        const Vec3 index = to_index.apply(pick->point_lps_mm);
        const Vec3 from_centre{index[0] - 10, index[1] - 10, index[2] - 10};
        EXPECT_NEAR(std::sqrt(dot(from_centre, from_centre)), 7, 1.2);
        EXPECT_LT(dot(from_ray, view.forward_lps), 0) << "the near side is in front of the middle";
      }
      for (const auto& [x, y] : {std::pair(0.5, 0.5),
                                 {-1.0, 5.0},
                                 {5.0, 40.0},
                                 {40.0, 5.0},
                                 {NAN, 5.0},
                                 {5.0, NAN},
                                 {HUGE_VAL, 5.0}}) {
        EXPECT_FALSE(frame.pick(x, y)) << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
