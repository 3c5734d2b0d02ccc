#include "player/frame/pick_structure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "player/frame/render_overrides.h"
#include "player/surfaces/clip_triangle.h"
#include "player/view/shear.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/perspective.h"
#include "tests/reference/ray.h"
#include "tests/reference/ray_surfaces.h"
#include "tests/reference/reference_surfaces.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

/// Contribution of each structure, composited front to back.
template <typename Layers>
std::map<StructureIndex, double> shares_of(const Layers& layers) {
  std::map<StructureIndex, double> shares;
  double transmittance = 1;
  for (const auto& layer : layers) {
    shares[layer.structure] += transmittance * layer.opacity;
    transmittance *= 1 - layer.opacity;
  }
  return shares;
}

/// Brute-force contributions to a pixel: nearest voxels and all crossings, sorted by depth.
std::map<StructureIndex, double> contributions(const RandomScene& scene, int column, int row) {
  const Grid grid = storage_grid(scene.content);
  const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
  const Shear shear = factorise(view, grid);
  const reference::OpticalField field = reference::optical_field(scene.content, scene.selection, view, false);
  const DrawPlan plan = DecisionTree(scene.content.graph, scene.content.classes).plan(scene.selection);
  struct Layer {
    double depth;
    int surface_first;
    double opacity;
    StructureIndex structure;
  };
  std::vector<Layer> layers;
  const reference::SurfacesInView surfaces(scene.content, scene.selection, view, shear.principal,
                                           reference::Coverage::kSnapped);
  for (const reference::Crossing& crossing : surfaces.crossings(column + 0.5, row + 0.5)) {
    layers.push_back({crossing.depth, 0, crossing.rgba[3], crossing.structure});
  }
  const reference::Ray ray = reference::ray_through(view, grid, column + 0.5, row + 0.5);
  const std::size_t axis = shear.scan.slice_axis;
  for (std::int64_t k = 0; k < grid.size[axis]; ++k) {
    const Vec3 at = ray.at((static_cast<double>(k) - ray.start[axis]) / ray.per_mm[axis]);
    const Index3 voxel{std::llround(at[0]), std::llround(at[1]), std::llround(at[2])};
    if (!grid.contains(voxel[0], voxel[1], voxel[2])) continue;
    const auto n = static_cast<std::size_t>(grid.offset(voxel[0], voxel[1], voxel[2]));
    const double depth = field.voxels[n].extinction * shear.slab_mm;
    if (depth <= 0) continue;
    const auto draw = std::find_if(plan.classes.begin(), plan.classes.end(),
                                   [&](const ClassDraw& d) { return d.id == scene.content.class_volume[n]; });
    layers.push_back(
        {static_cast<double>(shear.ascending ? k : -k), 1, -std::expm1(-depth), draw->volume_of});
  }
  std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) {
    return a.depth != b.depth ? a.depth < b.depth : a.surface_first < b.surface_first;
  });
  return shares_of(layers);
}

TEST(Pick, NamesTheStructureThatContributesMost) {
  int picked = 0;
  int nothing = 0;
  for (std::uint32_t number = 0; number < 80; ++number) {
    RandomScene scene = random_scene(number);
    scene.options.antialiasing = false;  // the ray of the pixel's centre
    Renderer renderer(open_in_memory(scene.content), {1, 0});
    ASSERT_TRUE(renderer.select(scene.selection));
    (void)render_or_throw(renderer, scene.camera, scene.options, scene.overrides);
    for (int n = 0; n < 12; ++n) {
      const int column = (7 * n + 3) % scene.options.size.width;
      const int row = (5 * n + 1) % scene.options.size.height;
      const auto shares = contributions(scene, column, row);
      double max = 0;
      for (const auto& [structure, share] : shares) max = std::max(max, share);
      const auto pick = renderer.pick(column + 0.5, row + 0.5);
      if (std::abs(max - 0.02) < 1e-4) continue;  // too close to the limit
      ASSERT_EQ(pick.has_value(), max >= 0.02) << "scene " << number << " pixel " << column << ", " << row;
      if (!pick) {
        ++nothing;
        continue;
      }
      // The maximum, or equal to it within rounding.
      ASSERT_TRUE(shares.contains(pick->structure));
      EXPECT_NEAR(shares.at(pick->structure), max, 1e-4) << "scene " << number;
      ++picked;
    }
  }
  EXPECT_GT(picked, 150);
  EXPECT_GT(nothing, 100);
}

/// Brute-force contributions along any ray: the nearest voxels in every plane of its main axis, and surfaces.
/// Nothing where 0.01 pixels change the crossed surfaces.
std::optional<std::map<StructureIndex, double>> contributions_along(const RandomScene& scene,
                                                                    const View& view, int column, int row) {
  const Grid grid = storage_grid(scene.content);
  const auto ray_at = [&](double x, double y) {
    return reference::ray_through(view, scene.camera.field_of_view_deg, grid, x, y);
  };
  const double x = column + 0.5, y = row + 0.5;
  const reference::Ray ray = ray_at(x, y);
  const reference::RaySurfaces surfaces(scene.content, scene.selection, view);
  if (surfaces.near_edge(ray, ray_at(x + 0.01, y), ray_at(x, y + 0.01))) return std::nullopt;
  std::size_t axis = 2;
  for (const std::size_t a : {1u, 0u}) {
    if (std::abs(ray.per_mm[a]) > std::abs(ray.per_mm[axis])) axis = a;
  }
  struct Layer {
    double s_mm, opacity;
    StructureIndex structure;
  };
  std::vector<Layer> layers;
  for (const reference::Crossing& crossing :
       surfaces.crossings(ray, view.eye_mm ? kNearPlane * *view.eye_mm : -HUGE_VAL)) {
    layers.push_back({crossing.s_mm, crossing.rgba[3], crossing.structure});
  }
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
  return shares_of(layers);
}

TEST(Pick, NamesTheStructureThatContributesMostInFramesOfRays) {
  int picked = 0, nothing = 0;
  for (std::uint32_t number = 0; number < 90; ++number) {
    RandomScene scene = random_scene(number);
    scene.options.antialiasing = false;
    if (number % 3 == 0) {
      scene.options.classification = Classification::kAfter;
    } else {
      scene.camera.projection = CameraProjection::kPerspective;
      scene.camera.field_of_view_deg = number % 3 == 1 ? 20 : 50;
    }
    Renderer renderer(open_in_memory(scene.content), {1, 0});
    ASSERT_TRUE(renderer.select(scene.selection));
    if (!render_with(renderer, scene.camera, scene.options, scene.overrides))
      continue;  // too wide for surfaces
    const View view = *view_of(scene.camera, scene.options.size, scene.content.display);
    for (int n = 0; n < 12; ++n) {
      const int column = (7 * n + 3) % scene.options.size.width;
      const int row = (5 * n + 1) % scene.options.size.height;
      const auto shares = contributions_along(scene, view, column, row);
      if (!shares) continue;
      double max = 0;
      for (const auto& [structure, share] : *shares) max = std::max(max, share);
      if (std::abs(max - 0.02) < 1e-4) continue;  // too close to the limit
      const auto pick = renderer.pick(column + 0.5, row + 0.5);
      ASSERT_EQ(pick.has_value(), max >= 0.02) << "scene " << number << " pixel " << column << ", " << row;
      (pick ? picked : nothing) += 1;
      if (!pick) continue;
      ASSERT_TRUE(shares->contains(pick->structure));
      EXPECT_NEAR(shares->at(pick->structure), max, 1e-4) << "scene " << number;
      // On the ray, in front of the eye.
      const ViewDepth depth(view, storage_grid(scene.content));
      const Vec3 index = lps_mm_to_index(storage_grid(scene.content)).apply(pick->point_lps_mm);
      const double mm = reference::dot(reference::minus(pick->point_lps_mm, view.plane.center_lps_mm),
                                       view.plane.forward_lps);
      EXPECT_GE(mm, view.eye_mm ? -*view.eye_mm * (1 + 1e-9) : -HUGE_VAL);
      const Vec3 on_ray = depth.index_at(column + 0.5, row + 0.5, mm);
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(on_ray[a], index[a], 1e-3);
    }
  }
  EXPECT_GT(picked, 150);
  EXPECT_GT(nothing, 100);
}

TEST(Pick, PointsLieOnThePixelsRayWhereTheStructureIs) {
  TestVolume volume;
  volume.grid = {{20, 20, 20}, {1.5, 1, 2}, {10, -20, 30}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  volume.structures = {{"ball", make_mask(volume.grid.size, [](auto i, auto j, auto k) {
                          return (i - 10) * (i - 10) + (j - 10) * (j - 10) + (k - 10) * (k - 10) < 50;
                        })}};
  const AtlasContent content = make_content(volume);
  const Affine to_index = lps_mm_to_index(storage_grid(content));
  for (const char* text : {"ball:surface", "ball:volume(opacity=1)"}) {
    Renderer renderer(open_in_memory(content), {1, 0});
    ASSERT_TRUE(renderer.select(selection_of(text, content.graph)));
    EXPECT_FALSE(renderer.pick(5, 5)) << "nothing was rendered yet";
    for (const double azimuth : {0.0, 33.0, 120.0, 250.0}) {
      Camera camera;
      camera.azimuth_deg = azimuth;
      camera.elevation_deg = 20;
      const PictureSize size{40, 40};
      (void)render_or_throw(renderer, camera, {.size = size});
      const ParallelView view = *parallel_view(camera, size, content.display);
      for (const auto& [x, y] : {std::pair(20.5, 20.5), {20.1, 17.9}, {23.7, 22.2}}) {
        const auto pick = renderer.pick(x, y);
        ASSERT_TRUE(pick);
        const Vec3 from_ray = reference::minus(pick->point_lps_mm, view.point_lps_mm(x, y));
        EXPECT_NEAR(reference::dot(from_ray, view.right_lps), 0, 1e-9);
        EXPECT_NEAR(reference::dot(from_ray, view.up_lps), 0, 1e-9);
        // The near side of the ball, whose surface is about 7 voxels from its centre.
        const Vec3 index = to_index.apply(pick->point_lps_mm);
        const Vec3 from_centre{index[0] - 10, index[1] - 10, index[2] - 10};
        EXPECT_NEAR(std::sqrt(reference::dot(from_centre, from_centre)), 7, 1.2);
        EXPECT_LT(reference::dot(from_ray, view.forward_lps), 0) << "the near side is in front of the middle";
      }
      for (const auto& [x, y] : {std::pair(0.5, 0.5),
                                 {-1.0, 5.0},
                                 {5.0, 40.0},
                                 {40.0, 5.0},
                                 {NAN, 5.0},
                                 {5.0, NAN},
                                 {HUGE_VAL, 5.0}}) {
        EXPECT_FALSE(renderer.pick(x, y)) << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
