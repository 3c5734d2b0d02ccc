// Random scenes by rays, in both projections and classifications, against the definition.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "player/frame/render_overrides.h"
#include "tests/reference/interpolated_greys.h"
#include "tests/reference/perspective.h"
#include "tests/reference/picture_difference.h"
#include "tests/reference/reference_volume.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

using reference::ReferencePicture;

/// Rays of a view in either projection.
struct Rays {
  View view;
  const Grid& grid;

  [[nodiscard]] reference::Ray through(int column, int row) const {
    const double x = column + 0.5, y = row + 0.5;
    if (!view.eye_mm) return reference::ray_through(view.plane, grid, x, y);
    return reference::ray_through(reference::PerspectiveView{view.plane, field_of_view_deg}, grid, x, y);
  }
  double field_of_view_deg = 30;
};

/// A volume, and a camera that may stand in it.
RandomScene volume_scene(std::uint32_t number) {
  RandomScene scene = random_scene(number, 9);
  for (StructureDraw& draw : scene.selection.structures) {
    if (draw.mode != DrawMode::kOff) draw.mode = DrawMode::kVolume;
  }
  scene.options.size.width = std::min(scene.options.size.width, 14);
  scene.options.size.height = std::min(scene.options.size.height, 14);
  scene.options.quality = Quality::kHigh;
  scene.options.hybrid_shading = false;
  scene.options.termination_threshold = 0;
  if (number % 3 != 0) {
    scene.camera.projection = CameraProjection::kPerspective;
    scene.camera.field_of_view_deg = std::array{0.01, 30.0, 75.0, 120.0, 170.0}[number % 5];
  }
  return scene;
}

/// All of a ray that can meet the grid lies within so many mm of where it starts.
double reach_mm(const Rays& rays, const Display& display) {
  const Vec3 from = rays.view.eye_mm ? rays.view.eye_lps_mm() : rays.view.plane.center_lps_mm;
  const Vec3 way = reference::minus(display.center_lps_mm, from);
  const Grid& grid = rays.grid;
  double diagonal = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    diagonal += std::pow(2 * static_cast<double>(grid.size[a] + 2) * grid.spacing_mm[a], 2);
  }
  const double aside =
      rays.view.plane.mm_per_pixel * std::hypot(rays.view.plane.size.width, rays.view.plane.size.height);
  return std::sqrt(reference::dot(way, way)) + std::sqrt(diagonal) + (rays.view.eye_mm ? 0 : aside);
}

TEST(RandomRays, AreWhatTheDefinitionSays) {
  for (std::uint32_t n = 0; n < 60; ++n) {
    RandomScene scene = volume_scene(n);
    const auto view = view_of(scene.camera, scene.options.size, scene.content.display);
    ASSERT_TRUE(view);
    const Grid grid = storage_grid(scene.content);
    const Rays rays{*view, grid, scene.camera.field_of_view_deg};
    scene.options.classification = Classification::kAfter;
    Renderer renderer(open_in_memory(scene.content), {1, 0});
    ASSERT_TRUE(renderer.select(scene.selection));
    const auto picture = render_with(renderer, scene.camera, scene.options, scene.overrides);
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_LE(reference::energy_violation(*picture), 1e-5) << n << ": " << describe(scene);

    const reference::InterpolatedGreys truth(scene.content, scene.selection);
    const double reach = reach_mm(rays, scene.content.display);
    ReferencePicture expected{scene.options.size, {}};
    for (int row = 0; row < scene.options.size.height; ++row) {
      for (int column = 0; column < scene.options.size.width; ++column) {
        const reference::Ray ray = rays.through(column, row);
        // From a far eye on, only what is around the grid.
        const double from = view->eye_mm ? std::max(0.0, reach - 200) : -reach;
        const reference::RayRadiance light = truth.along(ray, from, reach, 4000);
        expected.pixels.push_back({light.color[0], light.color[1], light.color[2], 1 - light.transmittance});
      }
    }
    const auto d = difference(*picture, expected);
    EXPECT_LE(255 * d.rms, 0.5) << n << ": " << describe(scene) << ": " << to_text(d);
  }
}

}  // namespace
}  // namespace splatlas
