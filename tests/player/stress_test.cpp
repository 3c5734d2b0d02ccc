// Stress cases of docs/renderer.md that no other test covers.
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "player/render/frame/frame_renderer.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/fails_with.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"
#include "tests/support/uniform_box.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

RenderOptions by_rays(const PictureSize& size) {
  return {.size = size, .classification = Classification::kAfter, .hybrid_shading = false};
}

/// At the switch of the principal axis, and 1e-6 rad to either side: finite values, within the cost of
/// slicing a smooth field along another axis (0.2/255; rays: 0.1/255).
TEST(Stress, AnAxisSwitchIsSmall) {
  const StandardScene scene = blobs_scene();
  Renderer renderer = renderer_of(scene.content, scene.selection);
  for (const auto& [azimuth, elevation] : {std::pair(45.0, 0.0), {45.0, 15.0}, {0.0, 45.0}, {135.0, 25.0}}) {
    for (const bool rays : {false, true}) {
      const RenderOptions options{.size = {48, 48},
                                  .classification = rays ? Classification::kAfter : Classification::kBefore};
      const Camera camera{.azimuth_deg = azimuth, .elevation_deg = elevation};
      const Picture there = render_or_throw(renderer, camera, options);
      for (const double aside : {-1e-6, 1e-6}) {
        Camera beside = camera;
        beside.azimuth_deg += elevation == 45.0 ? 0 : aside * 180 / std::numbers::pi;
        beside.elevation_deg += elevation == 45.0 ? aside * 180 / std::numbers::pi : 0;
        const Picture picture = render_or_throw(renderer, beside, options);
        EXPECT_LE(reference::energy_violation(picture), 1e-6);
        EXPECT_LE(reference::whole_picture_rms(picture, there), rays ? 0.1 : 0.2)
            << azimuth << ' ' << elevation << ' ' << rays;
      }
    }
  }
}

/// Steep edges from transparent to nearly opaque, with finer sheets so that both axes agree. At 1.5 and 2
/// sheet pixels per picture pixel the maxima would be 1.2 and 0.65.
TEST(Stress, AnAxisSwitchIsSmallAtSharpEdges) {
  const StandardScene scene = labels_scene();
  Renderer renderer = renderer_of(scene.content, scene.selection);
  for (const auto& [quality, max_rms] : {std::pair(Quality::kNormal, 0.8), {Quality::kHigh, 0.4}}) {
    for (const double elevation : {5.0, 15.0, 25.0}) {
      const Camera camera{.azimuth_deg = 45, .elevation_deg = elevation};
      const RenderOptions options{.size = {72, 72}, .quality = quality};
      const Picture along_x = render_or_throw(renderer, camera, options, {.principal_axis = Axis::kX});
      const Picture along_y = render_or_throw(renderer, camera, options, {.principal_axis = Axis::kY});
      EXPECT_LE(reference::whole_picture_rms(along_x, along_y), max_rms) << elevation;
    }
  }
}

/// A thousand pixels per voxel, and a hundred voxels per pixel.
TEST(Stress, ZoomsFromHundredthsToThousandsOfPixelsAVoxel) {
  const AtlasContent plate = box_content({400, 7, 400});
  const float opacity = 0.12f;
  Renderer renderer = renderer_of(plate, with_opacity(plate, opacity));
  for (const bool rays : {false, true}) {
    for (const double pixels_per_voxel : {0.01, 0.1, 10.0, 1000.0}) {
      RenderOptions options{.size = {3, 3}, .hybrid_shading = false};
      if (rays) options = by_rays({3, 3});
      const Camera camera{.zoom = zoom_for(plate.display, 3, 1 / pixels_per_voxel),
                          .center_lps_mm = Vec3{200.3, 3, 200.4}};
      const Picture picture = render_or_throw(renderer, camera, options);
      EXPECT_NEAR(picture.at(1, 1)[3], opacity_through(7, opacity), 4e-6) << pixels_per_voxel << rays;
      EXPECT_LE(reference::energy_violation(picture), 1e-6);
    }
  }
}

/// Invalid cameras and picture sizes are refused ahead of reading and allocation.
TEST(Stress, BadCamerasAndSizesAreRefusedAndNothingIsRead) {
  const StandardScene scene = hybrid_scene();
  const auto atlas = open_in_memory(scene.content);
  Renderer renderer(atlas, {1, 0});
  ASSERT_TRUE(renderer.select(scene.selection));
  const std::uint64_t read = atlas->counters().read;
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    for (const Classification classification : {Classification::kBefore, Classification::kAfter}) {
      const auto refused = [&](Camera camera, const PictureSize& size) {
        camera.projection = projection;
        Frame frame;
        EXPECT_THAT(renderer.render(camera, {.size = size, .classification = classification}, frame),
                    FailsWith(ErrorCode::kUsage, testing::_));
        EXPECT_EQ(frame.picture.rgba.capacity(), 0u);
      };
      for (const double bad : {kNan, kInfinity, -kInfinity}) {
        refused({.azimuth_deg = bad}, {8, 8});
        refused({.elevation_deg = bad}, {8, 8});
        refused({.zoom = bad}, {8, 8});
        refused({.center_lps_mm = Vec3{0, bad, 0}}, {8, 8});
      }
      refused({.zoom = 0}, {8, 8});
      for (const PictureSize& size : {PictureSize{0, 0}, {0, 8}, {8, -1}, {100000, 100000}}) {
        refused({}, size);
      }
      if (projection == CameraProjection::kParallel) continue;
      for (const double bad : {kNan, kInfinity, 0.0, -30.0, 180.0}) {
        refused({.field_of_view_deg = bad}, {8, 8});
      }
    }
  }
  EXPECT_EQ(atlas->counters().read, read);
  EXPECT_EQ(atlas->counters().decoded, 0u);
}

}  // namespace
}  // namespace splatlas
