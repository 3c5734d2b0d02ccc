// Drafts with surfaces of coarser levels.
#include <cmath>

#include <gtest/gtest.h>

#include "player/renderer.h"
#include "tests/support/fit_parts.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

/// A ball that a wavy border cuts in two.
AtlasContent two_halves() {
  TestVolume volume;
  volume.grid.size = {90, 90, 60};
  volume.grid.spacing_mm = {1, 1, 1.5};
  const auto half = [&](bool left) {
    return make_mask(volume.grid.size, [left](std::int64_t i, std::int64_t j, std::int64_t k) {
      const double x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
      const bool in_ball =
          std::pow((x - 44) / 40, 2) + std::pow((y - 45) / 40, 2) + std::pow((z - 30) / 26, 2) < 1;
      return in_ball && (x < 45 + 4 * std::sin(y / 8)) == left;
    });
  };
  volume.structures = {{"left", half(true), {255, 60, 30}}, {"right", half(false), {40, 90, 255}}};
  return fitted(make_content(volume));
}

RenderOptions draft(double budget_ms) {
  return {.size = {96, 96}, .quality = Quality::kDraft, .draft_budget_ms = budget_ms};
}

/// Voxels are up to 1.5 mm wide.
Camera camera_of(const AtlasContent& content, double pixels_per_mm) {
  return {.azimuth_deg = 25, .elevation_deg = 15, .zoom = zoom_for(content.display, 96, 1 / pixels_per_mm)};
}

constexpr double kAmple = 1e6, kNone = 1e-9;  // budgets in ms

/// Pixels whose coverage differs although their neighbours' is the same as theirs.
int far_differences(const Picture& picture, const Picture& exact) {
  const auto [width, height] = exact.size;
  int differences = 0;
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const float expected = exact.at(x, y)[3];
      if (picture.at(x, y)[3] == expected) continue;
      bool at_silhouette = false;
      for (int n = 0; n < 9; ++n)
        at_silhouette = at_silhouette || exact.at(x + n % 3 - 1, y + n / 3 - 1)[3] != expected;
      differences += at_silhouette ? 0 : 1;
    }
  }
  return differences;
}

TEST(SurfaceLevels, SilhouettesOfZoomedOutDraftsAreExactWithinAPixel) {
  const AtlasContent content = two_halves();
  for (std::size_t n = 0; n < 6; ++n) {
    const char* const text = std::array{"left:surface + right:surface", "left:surface",
                                        "left:surface + right:volume(opacity=0.1)"}[n % 3];
    for (const auto& [pixels_per_mm, level] : {std::pair(0.35, 2), {0.7, 1}}) {
      SCOPED_TRACE(text);
      Renderer renderer = renderer_of(content, selection_of(text, content.graph));
      Camera camera = camera_of(content, pixels_per_mm);
      if (n >= 3) camera.projection = CameraProjection::kPerspective;
      const Frame exact = frame_or_throw(renderer, camera, draft(0));
      const Frame coarse = frame_or_throw(renderer, camera, draft(kAmple));
      EXPECT_EQ(exact.stats.surface_level, 0);
      EXPECT_EQ(coarse.stats.surface_level, level);
      EXPECT_LT(coarse.stats.triangles << (2 * level), exact.stats.triangles * 6 / 5);
      EXPECT_EQ(far_differences(coarse.picture, exact.picture), 0);
      double sum = 0;
      for (std::size_t n = 0; n < exact.picture.rgba.size(); ++n)
        sum += std::abs(static_cast<double>(coarse.picture.rgba[n] - exact.picture.rgba[n]));
      EXPECT_LT(sum / static_cast<double>(exact.picture.rgba.size()), 2.0 / 255);
    }
  }
}

/// The first draft does not wait for the surfaces of level 0; once they exist, drafts draw them.
TEST(SurfaceLevels, StandInUntilSurfacesAreDerived) {
  const AtlasContent content = two_halves();
  Renderer renderer = renderer_of(content, selection_of("left:surface + right:surface", content.graph));
  const Camera camera = camera_of(content, 1.3);
  EXPECT_EQ(frame_or_throw(renderer, camera, draft(kNone)).stats.surface_level, 1);
  RenderOptions normal = draft(kNone);
  normal.quality = Quality::kNormal;
  EXPECT_EQ(frame_or_throw(renderer, camera, normal).stats.surface_level, 0);
  (void)frame_or_throw(renderer, camera, draft(kAmple));  // the first draft was late
  EXPECT_EQ(frame_or_throw(renderer, camera, draft(kAmple)).stats.surface_level, 0);
  EXPECT_EQ(frame_or_throw(renderer, camera, draft(kNone)).stats.surface_level, 0);
  EXPECT_EQ(frame_or_throw(renderer, camera, draft(kNone)).stats.surface_level, 1)
      << "the latest draft was late";
}

TEST(SurfaceLevels, PicksNameWhatTheDraftShows) {
  const AtlasContent content = two_halves();
  Renderer renderer = renderer_of(content, selection_of("left:surface + right:surface", content.graph));
  const Camera camera = camera_of(content, 0.7);
  const Frame coarse = frame_or_throw(renderer, camera, draft(kAmple));
  ASSERT_EQ(coarse.stats.surface_level, 1);
  int picked = 0;
  for (int y = 0; y < 96; y += 5) {
    for (int x = 0; x < 96; x += 5) {
      const auto rgba = coarse.picture.at(x, y);
      const std::optional<Pick> pick = coarse.pick(x + 0.5, y + 0.5);
      ASSERT_EQ(pick.has_value(), rgba[3] > 0) << x << " " << y;
      if (!pick) continue;
      ++picked;
      EXPECT_EQ(pick->structure, rgba[0] > rgba[2] ? 0u : 1u) << x << " " << y;
    }
  }
  EXPECT_GT(picked, 50);
}

/// Ids and depth maps are exact, and so are surfaces that do not follow from the voxels.
TEST(SurfaceLevels, KeepExactWhatMustBe) {
  const AtlasContent content = two_halves();
  Renderer renderer = renderer_of(content, selection_of("left:surface", content.graph));
  const Camera camera = camera_of(content, 0.35);
  RenderOptions ids = draft(kAmple), depths = draft(kAmple);
  ids.ids = depths.depths = true;
  for (const RenderOptions& options : {ids, depths})
    EXPECT_EQ(frame_or_throw(renderer, camera, options).stats.surface_level, 0);
  AtlasContent external = two_halves();
  external.surfaces[0].positions_ijk[0][0] += 1.0f / 256;  // no longer that of the voxels
  Renderer other = renderer_of(external, selection_of("left:surface", content.graph));
  const Frame exact = frame_or_throw(other, camera, draft(0)),
              coarse = frame_or_throw(other, camera, draft(kAmple));
  EXPECT_FALSE(other.atlas().has_levels(0));
  EXPECT_TRUE(other.atlas().has_levels(1));
  EXPECT_EQ(coarse.picture.rgba, exact.picture.rgba);
}

}  // namespace
}  // namespace splatlas
