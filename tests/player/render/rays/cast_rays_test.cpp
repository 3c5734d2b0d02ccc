// Pictures by rays: in perspective, and of grey values classified after interpolation.
#include "player/render/rays/cast_rays.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/player/prepared_selection.h"
#include "tests/reference/grey_truth.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/fails_with.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

using reference::GreyTruth;
using reference::PerspectiveView;
using reference::ReferencePicture;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Pixels are coarser than the voxels of some scenes.
constexpr RenderOverrides kOneRay{.one_ray = true};

/// A cube of one grey value, 21 voxels of 1 mm a side, its middle at the origin.
AtlasContent fog() {
  TestVolume volume;
  volume.grid.size = {21, 21, 21};
  volume.grid.origin_lps_mm = {-10, -10, -10};
  volume.structures = {{"fog", full_mask(volume.grid.size), {255, 255, 255}}};
  volume.values = make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(21 * 21 * 21, 200));
  volume.window_high = 200;
  return make_content(volume);
}

Camera perspective(double field_of_view_deg = 30) {
  return {.azimuth_deg = 33,
          .elevation_deg = 21,
          .projection = CameraProjection::kPerspective,
          .field_of_view_deg = field_of_view_deg};
}

/// Puts the eye at a point, whatever the size of the picture.
Camera with_eye_at(const Vec3& eye, Camera camera, const PictureSize& size, const Display& display) {
  camera.center_lps_mm = eye;
  const View view = *view_of(camera, size, display);
  for (std::size_t a = 0; a < 3; ++a) (*camera.center_lps_mm)[a] += *view.eye_mm * view.plane.forward_lps[a];
  return camera;
}

RenderOptions accurate(Quality quality = Quality::kNormal) {
  return {.size = {40, 36},
          .quality = quality,
          .classification = Classification::kAfter,
          .hybrid_shading = false};
}

/// Ground truth of a selection with one appearance and byte grey values.
ReferencePicture truth_of(const StandardScene& scene, const Camera& camera, const PictureSize& size) {
  const auto volume = reference::masked_volume(scene.content, scene.selection);
  const Grid& grid = volume->grid;
  const auto appearance = reference::grey_appearance(
      *std::find_if(scene.selection.structures.begin(), scene.selection.structures.end(),
                    [](const StructureDraw& draw) { return draw.mode != DrawMode::kOff; }),
      scene.content.display, reference::voxel_side_mm(grid));
  const GreyTruth truth(*volume, *appearance, Classification::kAfter);
  const View view = *view_of(camera, size, scene.content.display);
  if (!view.eye_mm) return render_grey_truth(truth, grid, view.plane, 1);
  return render_grey_truth(truth, grid, PerspectiveView{view.plane, camera.field_of_view_deg}, 1);
}

/// A smooth ball of bytes with a dent, cut out of nothing on one side.
StandardScene smooth_bytes(const std::string& options) {
  TestVolume volume;
  volume.grid.size = {26, 24, 25};
  volume.grid.spacing_mm = {1, 1.1, 0.9};
  volume.structures = {{"ball", box_mask(volume.grid.size, {0, 0, 0}, {18, 23, 24}), {255, 160, 90}}};
  std::vector<std::uint8_t> greys;
  for (int k = 0; k < 25; ++k) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 26; ++i) {
        const double ball = std::exp(-(std::pow(i - 12, 2) + std::pow(j - 12, 2) + std::pow(k - 12, 2)) / 60);
        const double dent = std::exp(-(std::pow(i - 9, 2) + std::pow(j - 8, 2) + std::pow(k - 15, 2)) / 12);
        greys.push_back(static_cast<std::uint8_t>(std::lround(std::max(0.0, 230 * ball - 90 * dent))));
      }
    }
  }
  volume.values = make_values(VoxelType::kUInt8, greys);
  volume.window_low = 40;
  volume.window_high = 200;
  StandardScene scene{"smooth", make_content(volume), {}};
  scene.selection =
      selection_of(options.empty() ? "ball:volume" : "ball:volume(" + options + ")", scene.content.graph);
  return scene;
}

TEST(CastRays, AnEyeInTheFogSeesWhatLiesAhead) {
  const AtlasContent content = fog();
  const Selection selection = selection_of("fog:volume(opacity=0.05)", content.graph);
  RenderOptions options = accurate(Quality::kHigh);
  options.size = {33, 33};
  for (const Classification classification : {Classification::kBefore, Classification::kAfter}) {
    options.classification = classification;
    Camera camera = perspective(60);
    camera.azimuth_deg = 90;
    camera.elevation_deg = 0;
    for (const double ahead : {0.0, 3.25, 9.5, 30.0}) {
      const Picture picture = render_or_throw(
          content, selection, with_eye_at({ahead, 0, 0}, camera, options.size, content.display), options);
      // Beside the last voxel's centre the soft ramp falls to nothing within a mm, linearly in both.
      const double length = ahead > 11 ? 21 : 10.5 + std::min(ahead, 10.0);
      const double depth = -std::log(1 - 0.05) * length;
      EXPECT_NEAR(picture.at(16, 16)[3], 1 - std::exp(-depth), 2e-4) << ahead;
    }
  }
}

// Found by fuzzing: rays were differences of places that are the same for numbers so close.
TEST(CastRays, AnEyeAtThePointThatItLooksAtSeesAsOneNearIt) {
  AtlasContent content = fog();
  content.display.center_lps_mm = {3.2, 1, -2};
  const Selection selection = selection_of("fog:volume(opacity=0.05)", content.graph);
  content.display.radius_mm = 1e-6;
  const Picture near = render_or_throw(content, selection, perspective(60), accurate());
  EXPECT_GT(near.at(0, 0)[3], 0.2);
  EXPECT_GT(std::abs(near.at(0, 0)[3] - near.at(39, 35)[3]), 0.01);
  content.display.radius_mm = 1e-60;
  const Picture at = render_or_throw(content, selection, perspective(60), accurate());
  for (std::size_t n = 0; n < at.rgba.size(); ++n) EXPECT_NEAR(at.rgba[n], near.rgba[n], 2e-6) << n;
}

/// Found by random scenes. A transfer function that shows any grey value above 0 fills the space within one
/// voxel of a structure. Rays that cut off an edge of it are inside for a small part of a slab.
TEST(CastRays, StepsAtABorderAreMetByRaysThatPassAnEdge) {
  const AtlasContent content = fog();
  const Selection selection = selection_of("fog:volume(curve=0:0/0.000001:0.5)", content.graph);
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    Camera camera = perspective(90);
    camera.projection = projection;
    const RenderOptions options = accurate(Quality::kHigh);
    const Picture picture = render_or_throw(content, selection, camera, options, 1, kOneRay);
    const View view = *view_of(camera, options.size, content.display);
    const Grid grid = storage_grid(content);
    int passed = 0;
    for (int y = 0; y < options.size.height; ++y) {
      for (int x = 0; x < options.size.width; ++x) {
        const reference::Ray ray =
            reference::ray_through(view, camera.field_of_view_deg, grid, x + 0.5, y + 0.5);
        const auto [from_mm, to_mm] = clip_to_field(ray, grid.size, {-kInfinity, kInfinity});
        const double length = std::max(0.0, to_mm - from_mm);
        passed += length > 0 && length < 0.5 ? 1 : 0;
        EXPECT_NEAR(picture.at(x, y)[3], 1 - std::pow(0.5, length), 2e-3) << x << ", " << y << ": " << length;
      }
    }
    EXPECT_GT(passed, 3);
  }
}

/// Around an eye in the middle, in every direction, whichever axis is the principal one.
TEST(CastRays, AWideFieldOfViewIsSeamless) {
  const AtlasContent content = fog();
  const Selection selection = selection_of("fog:volume(opacity=0.05)", content.graph);
  RenderOptions options = accurate(Quality::kHigh);
  options.size = {41, 41};
  for (const double degrees : {90.0, 120.0, 170.0}) {
    const Camera camera = with_eye_at({0, 0, 0}, perspective(degrees), options.size, content.display);
    const View view = *view_of(camera, options.size, content.display);
    const Picture picture = render_or_throw(content, selection, camera, options, 1, kOneRay);
    for (int y = 0; y < 41; ++y) {
      for (int x = 0; x < 41; ++x) {
        Vec3 along = reference::minus(view.plane.point_lps_mm(x + 0.5, y + 0.5), view.eye_lps_mm());
        const double max = std::max({std::abs(along[0]), std::abs(along[1]), std::abs(along[2])});
        const double per_mm = std::sqrt(dot(along, along)) / max;
        // 10 mm of fog and a border of one more that thins out: by half on the way through a side, and by
        // more where edges and corners are near.
        const double depth = -std::log(1 - 0.05) * per_mm;
        EXPECT_GE(picture.at(x, y)[3], 1 - std::exp(-depth * 10) - 1e-4) << x << ' ' << y;
        EXPECT_LE(picture.at(x, y)[3], 1 - std::exp(-depth * 10.5) + 1e-4) << x << ' ' << y;
      }
    }
  }
}

TEST(CastRays, AreCloseToTheTruthAtEveryQuality) {
  const PictureSize size = accurate().size;
  for (const char* appearance : {"", "opacity=0.01,profile=thin", "profile=hard,opacity=0.95"}) {
    const StandardScene scene = smooth_bytes(appearance);
    for (const bool in_perspective : {false, true}) {
      Camera camera = perspective();
      if (!in_perspective) camera.projection = CameraProjection::kParallel;
      const ReferencePicture truth = truth_of(scene, camera, size);
      Renderer renderer = renderer_of(scene.content, scene.selection);
      const auto rms = [&](Quality quality) {
        return 255 *
               reference::difference(render_or_throw(renderer, camera, accurate(quality), kOneRay), truth)
                   .rms;
      };
      EXPECT_LE(rms(Quality::kNormal), 0.5) << appearance << (in_perspective ? ", perspective" : "");
      EXPECT_LE(rms(Quality::kHigh), 0.1) << appearance << (in_perspective ? ", perspective" : "");
      EXPECT_LE(rms(Quality::kHigh), rms(Quality::kDraft)) << appearance;
    }
  }
}

/// Twice the steps, a quarter of the error.
TEST(CastRays, TheErrorFallsWithTheSquareOfTheSteps) {
  const StandardScene scene = smooth_bytes("");
  const Camera camera = perspective();
  const PictureSize size{40, 36};
  const ReferencePicture truth = truth_of(scene, camera, size);
  PreparedSelection prepared(scene.content, scene.selection);
  const RayVolume volume = prepared.rays(Classification::kAfter);
  const auto rms = [&](int steps) {
    Picture picture;
    cast_rays(volume, *view_of(camera, size, scene.content.display), prepared.atlas->grid(),
              {.min_steps = steps, .max_steps = steps}, best_march(), &picture, prepared.pool);
    return reference::difference(picture, truth).rms;
  };
  double before = rms(1);
  for (const int steps : {2, 4, 8}) {
    const double now = rms(steps);
    EXPECT_NEAR(std::log2(before / now), 2.0, 0.2) << steps;
    before = now;
  }
}

/// The border of structures that differ by colour alone is a blend of colours without a gap.
TEST(CastRays, ColoursMeetWithoutAGap) {
  TestVolume volume;
  volume.grid.size = {8, 8, 8};
  volume.structures = {{"a", box_mask(volume.grid.size, {0, 0, 0}, {3, 7, 7}), {255, 0, 0}},
                       {"b", box_mask(volume.grid.size, {4, 0, 0}, {7, 7, 7}), {0, 0, 255}}};
  volume.values = make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(512, 150));
  volume.window_high = 200;
  const AtlasContent content = make_content(volume);
  Camera camera = Camera::of(NamedView::kAnterior);
  camera.zoom = zoom_for(content.display, 41, 0.1);
  RenderOptions options = accurate(Quality::kHigh);
  options.size = {41, 41};
  const Picture two = render_or_throw(content, selection_of("a + b", content.graph), camera, options);
  for (int x = 0; x < 41; ++x) {
    EXPECT_NEAR(two.at(x, 20)[3], two.at(0, 20)[3], 1e-5) << x;  // as opaque everywhere
    EXPECT_NEAR(two.at(x, 20)[0] + two.at(x, 20)[2], two.at(0, 20)[0], 1e-5) << x;
  }
  EXPECT_NEAR(two.at(20, 20)[0], two.at(20, 20)[2], 1e-5);
  EXPECT_NEAR(two.at(0, 20)[2], 0, 1e-6);
  EXPECT_NEAR(two.at(40, 20)[0], 0, 1e-6);
}

/// Two voxels far apart: pages around them are counted, not the box between them.
TEST(CastRays, MemoryIsBounded) {
  TestVolume volume;
  volume.grid.size = {120, 120, 120};
  volume.structures = {{"ends", make_mask(volume.grid.size, [](auto i, auto j, auto k) {
                          return (i == 0 && j == 0 && k == 0) || (i == 119 && j == 119 && k == 119);
                        })}};
  volume.values = make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(120 * 120 * 120, 1));
  const AtlasContent content = make_content(volume);
  const auto picture_of = [&](std::uint64_t max_memory_bytes) {
    Renderer renderer(open_in_memory(content), {1, max_memory_bytes});
    EXPECT_TRUE(renderer.select(selection_of("ends", content.graph)));
    return renderer.render(perspective(), accurate());
  };
  EXPECT_TRUE(picture_of(std::uint64_t{1} << 18));
  EXPECT_THAT(picture_of(std::uint64_t{1} << 16), FailsWith(ErrorCode::kLimit, testing::_));
}

}  // namespace
}  // namespace splatlas
