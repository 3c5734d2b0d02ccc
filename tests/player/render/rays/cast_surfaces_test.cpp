// Surfaces between the parts of the volume, by rays.
#include <cmath>
#include <stop_token>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/tasks/task_control.h"
#include "player/render/rays/cast_rays.h"
#include "tests/player/prepared_selection.h"
#include "tests/scenes/ray_truth.h"
#include "tests/support/fails_with.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/render_with.h"
#include "tests/support/standard_scenes.h"
#include "tests/support/uniform_box.h"

namespace splatlas {
namespace {

/// Thick slices with an external surface, and a view along them but for 7 degrees: rays in planes of voxels.
RandomScene thick_slices(const char* selection) {
  TestVolume volume;
  volume.grid = {.size = {40, 40, 4}, .spacing_mm = {1, 1, 10}};
  SurfaceMesh needle;
  needle.positions_ijk = {{19.5f, 19.5f, 0.5f}, {20.5f, 19.5f, 0.5f}, {19.5f, 20.5f, 1.5f}};
  needle.normals_lps.assign(3, {0, 0, 1});
  needle.triangles = {{0, 1, 2}};
  volume.structures = {{"fog", full_mask(volume.grid.size), {255, 255, 255}},
                       {"cube", box_mask(volume.grid.size, {8, 8, 1}, {31, 31, 2}), {255, 0, 0}},
                       {"needle", {}, {0, 0, 255}, {}, needle}};
  RandomScene scene{make_content(volume), {}, {}, {}};
  scene.selection = selection_of(selection, scene.content.graph);
  scene.camera = {.elevation_deg = 83, .projection = CameraProjection::kPerspective};
  scene.options = {.size = {40, 30},
                   .quality = Quality::kHigh,
                   .hybrid_shading = false,
                   .antialiasing = false,
                   .termination_threshold = 0};
  scene.overrides.one_ray = true;
  return scene;
}

TEST(CastSurfaces, AreInOrderWhereRaysRunInPlanesOfThePrincipalAxis) {
  for (const char* const text : {"fog:volume(opacity=0.05) + cube:both(opacity=0.3)", "*:volume"}) {
    SCOPED_TRACE(text);
    const RandomScene scene = thick_slices(text);
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const Frame frame = value_or_throw(render_with(renderer, scene.camera, scene.options, scene.overrides));
    EXPECT_GT(frame.stats.triangles, 0u);
    const RayTruth truth(scene, false);
    std::size_t compared = 0, wrong = 0;
    for (int row = 0; row < 30; ++row) {
      for (int column = 0; column < 40; ++column) {
        const auto expected = truth.at(column, row);
        if (!expected) continue;
        double apart = 0;
        for (std::size_t c = 0; c < 4; ++c)
          apart = std::max(apart, std::abs(frame.picture.at(column, row)[c] - (*expected)[c]));
        ++compared;
        wrong += apart > 0.01 ? 1 : 0;
      }
    }
    EXPECT_GT(compared, 600u);
    EXPECT_LE(wrong, compared / 100);
  }
}

/// Every mode draws external surfaces: the remedy must not be another mode.
TEST(CastSurfaces, OfTooWideAFieldOfViewNameExternalOnes) {
  const StandardScene scene = hybrid_scene();
  const Camera camera{.azimuth_deg = 33,
                      .elevation_deg = 21,
                      .projection = CameraProjection::kPerspective,
                      .field_of_view_deg = 150};
  EXPECT_THAT(renderer_of(scene.content, scene.selection).render(camera, {.size = {20, 20}}),
              FailsWith(ErrorCode::kUsage, testing::HasSubstr("external surfaces, which every mode draws")));
}

/// The transmittance through both sides of an eye is the square of that through one side: fog, and the
/// translucent surface of the hollow in which the eye is.
TEST(CastSurfaces, AnEyeInsideSeesOneSideOfTheSurface) {
  TestVolume volume;
  volume.grid.size = {21, 21, 21};
  volume.grid.origin_lps_mm = {-10, -10, -10};
  volume.structures = {{"fog", full_mask(volume.grid.size), {255, 255, 255}},
                       {"cube", box_mask(volume.grid.size, {6, 6, 6}, {14, 14, 14})}};
  const AtlasContent content = make_content(volume);
  const Selection selection =
      selection_of("cube:surface(opacity=0.5) + fog:volume(opacity=0.1)", content.graph);
  const RenderOptions options{.size = {33, 33},
                              .quality = Quality::kHigh,
                              .classification = Classification::kAfter,
                              .hybrid_shading = false,
                              .termination_threshold = 0};
  Camera camera{.azimuth_deg = 90};
  const double both_sides = 1 - render_or_throw(content, selection, camera, options).at(16, 16)[3];
  camera.projection = CameraProjection::kPerspective;
  const View view = *view_of(camera, options.size, content.display);
  camera.center_lps_mm = Vec3{-*view.eye_mm, 0, 0};
  const double one_side = 1 - render_or_throw(content, selection, camera, options).at(16, 16)[3];
  EXPECT_LT(one_side, 0.5);
  EXPECT_NEAR(both_sides, one_side * one_side, 1e-3);
}

/// A stop request ends a job of many packets before its next packet.
TEST(CastSurfaces, StopsBetweenPackets) {
  static std::stop_source stop;
  static int packets = 0;
  constexpr MarchKernels kStopping{"stopping", [](const MarchScene&, const RayPacket&, RadiancePacket&) {
                                     ++packets;
                                     stop.request_stop();
                                   }};
  const AtlasContent content = box_content({8, 8, 8});
  PreparedSelection prepared(content, selection_of("*:both", content.graph));
  const RayVolume volume = prepared.rays(Classification::kBefore);
  Picture picture{{8, 8}, std::vector<float>(4 * 64)};
  const View view = *view_of({}, picture.size, content.display);
  const Lighting lighting(view.plane);
  const RasterScene scene = *raster_scene_of_rays({}, view, prepared.atlas->grid(), lighting);
  FragmentList fragments;  // a sample without fragments in every pixel
  fragments.samples.resize(65);
  for (std::uint32_t n = 0; n < 64; ++n) fragments.samples[n].pixel = n;
  TaskControl task(stop.get_token(), {});
  EXPECT_THROW(cast_surfaces(volume, view, prepared.atlas->grid(), scene, fragments, {}, kStopping, &picture,
                             prepared.pool),
               Cancelled);
  EXPECT_EQ(packets, 1);
}

}  // namespace
}  // namespace splatlas
