#include "player/camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/reference/ray.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr Vec3 kLeft{1, 0, 0}, kRight{-1, 0, 0}, kAnterior{0, -1, 0}, kPosterior{0, 1, 0}, kSuperior{0, 0, 1},
    kInferior{0, 0, -1};

ParallelView view_of(const Camera& camera, PictureSize size = {64, 48}) {
  return *parallel_view(camera, size, {0, 1, {5, -6, 7}, 40});
}

/// A named view: its direction, and the axes that point right and up.
struct NamedCase {
  const char* name;
  NamedView named;
  Vec3 from, right, up;
};
const NamedCase kNamedCases[] = {
    {"anterior", NamedView::kAnterior, kAnterior, kLeft, kSuperior},
    {"posterior", NamedView::kPosterior, kPosterior, kRight, kSuperior},
    {"left", NamedView::kLeft, kLeft, kPosterior, kSuperior},
    {"right", NamedView::kRight, kRight, kAnterior, kSuperior},
    {"superior", NamedView::kSuperior, kSuperior, kRight, kAnterior},
    {"inferior", NamedView::kInferior, kInferior, kLeft, kAnterior},
};

TEST(Camera, AzimuthTurnsAroundTheSuperiorAxisTowardsTheSubjectsLeft) {
  Camera camera{.azimuth_deg = 90};
  EXPECT_EQ(view_of(camera).forward_lps, kRight);  // from the left, looking right
  camera.azimuth_deg = 30;
  ParallelView view = view_of(camera);
  EXPECT_NEAR(dot(view.forward_lps, kRight), std::sin(30 * kDegree), 1e-15);
  EXPECT_NEAR(dot(view.forward_lps, kPosterior), std::cos(30 * kDegree), 1e-15);
  camera.elevation_deg = 25;  // from above
  view = view_of(camera);
  EXPECT_NEAR(dot(view.forward_lps, kInferior), std::sin(25 * kDegree), 1e-15);
  EXPECT_GT(dot(view.up_lps, kSuperior), 0);
}

RC_GTEST_PROP(Camera, AxesAreOrthonormalAndAnglesArePeriodic, ()) {
  Camera camera;
  camera.azimuth_deg = *rc::gen::inRange(-100000, 100000) / 64.0;  // exact, and so is 360 more
  camera.elevation_deg = *rc::gen::inRange(-100000, 100000) / 64.0;
  const ParallelView view = view_of(camera);
  RC_ASSERT(std::abs(dot(view.right_lps, view.right_lps) - 1) < 1e-14);
  RC_ASSERT(std::abs(dot(view.up_lps, view.up_lps) - 1) < 1e-14);
  RC_ASSERT(std::abs(dot(view.right_lps, view.up_lps)) < 1e-14);
  // Right, up and the direction to the viewer form a right-handed system: pictures are not mirrored.
  const Vec3 normal = cross(view.right_lps, view.up_lps);
  for (std::size_t a = 0; a < 3; ++a) RC_ASSERT(std::abs(normal[a] + view.forward_lps[a]) < 1e-14);
  camera.azimuth_deg += 360;
  camera.elevation_deg -= 720;
  RC_ASSERT(view_of(camera).forward_lps == view.forward_lps);
  RC_ASSERT(view_of(camera).up_lps == view.up_lps);
}

TEST(Camera, ZoomOneFitsTheBallIntoThePicture) {
  for (const PictureSize size : {PictureSize{64, 48}, {48, 64}, {1, 1}, {32768, 1}}) {
    Camera camera;
    const ParallelView view = view_of(camera, size);
    const double side_mm = view.mm_per_pixel * std::min(size.width, size.height);
    EXPECT_NEAR(2 * 40 / side_mm, 0.96, 1e-12);
    camera.zoom = 4;
    EXPECT_NEAR(view_of(camera, size).mm_per_pixel, view.mm_per_pixel / 4, 1e-12);
  }
}

TEST(Camera, PointsAreOnTheRaysOfTheirPixels) {
  Camera camera{.azimuth_deg = 20, .elevation_deg = -35};
  const ParallelView view = view_of(camera);
  EXPECT_EQ(view.point_lps_mm(32, 24), (Vec3{5, -6, 7}));  // the picture centre shows the centre of the ball
  const Vec3 moved = reference::minus(view.point_lps_mm(42, 19), view.center_lps_mm);
  EXPECT_NEAR(dot(moved, view.right_lps), 10 * view.mm_per_pixel, 1e-12);
  EXPECT_NEAR(dot(moved, view.up_lps), 5 * view.mm_per_pixel, 1e-12);
  EXPECT_NEAR(dot(moved, view.forward_lps), 0, 1e-12);
  camera.center_lps_mm = Vec3{1, 2, 3};
  EXPECT_EQ(view_of(camera).point_lps_mm(32, 24), (Vec3{1, 2, 3}));
}

void expect_refused(const Camera& camera, PictureSize size, const std::string& what) {
  const auto view = parallel_view(camera, size, Display{});
  ASSERT_FALSE(view.has_value()) << what;
  EXPECT_EQ(view.error().code, ErrorCode::kUsage) << what;
  EXPECT_NE(view.error().message.find(what), std::string::npos) << view.error().message;
  EXPECT_EQ(view.error().message.find('\n'), std::string::npos);
}

TEST(Camera, AnEyeSeesWhatTheParallelViewShowsInThePlaneOfTheCentre) {
  Camera camera{.azimuth_deg = 20, .elevation_deg = -35};
  const Display display{0, 1, {5, -6, 7}, 40};
  EXPECT_FALSE(view_of(camera, {64, 48}, display)->eye_mm);
  camera.projection = CameraProjection::kPerspective;
  camera.field_of_view_deg = 50;
  const View view = *view_of(camera, {64, 48}, display);
  EXPECT_EQ(view.plane.forward_lps, view_of(camera).forward_lps);
  const Vec3 eye = view.eye_lps_mm();
  const Vec3 ahead = reference::minus(view.plane.center_lps_mm, eye);
  EXPECT_NEAR(dot(ahead, view.plane.forward_lps), *view.eye_mm, 1e-9);
  const Vec3 top = reference::minus(view.plane.point_lps_mm(32, 0), eye);
  EXPECT_NEAR(dot(top, ahead) / std::sqrt(dot(top, top) * dot(ahead, ahead)), std::cos(25 * kDegree), 1e-12);
  // Nearer when zoomed in.
  camera.zoom = 100;
  EXPECT_NEAR(*view_of(camera, {64, 48}, display)->eye_mm, *view.eye_mm / 100, 1e-9);
}

TEST(Camera, RefusesFieldsOfViewThatSeeNothing) {
  Camera camera{.projection = CameraProjection::kPerspective};
  for (const double degrees : {0.0, -30.0, 1e-4, 179.5, 180.0, 360.0, kNan, kInfinity}) {
    camera.field_of_view_deg = degrees;
    const auto view = view_of(camera, {8, 8}, Display{});
    ASSERT_FALSE(view.has_value()) << degrees;
    EXPECT_EQ(view.error().code, ErrorCode::kUsage);
    EXPECT_NE(view.error().message.find("field of view"), std::string::npos) << view.error().message;
  }
  camera.field_of_view_deg = 30;
  EXPECT_TRUE(view_of(camera, {8, 8}, Display{}));
  for (const double radius_mm : {1e-310, 1e-200, 1e-102}) {
    const auto at_the_point = view_of(camera, {8, 8}, {.radius_mm = radius_mm});
    ASSERT_FALSE(at_the_point.has_value());
    EXPECT_NE(at_the_point.error().message.find("the eye is"), std::string::npos);
  }
  camera.projection = CameraProjection::kParallel;
  camera.field_of_view_deg = kNan;  // unused
  EXPECT_TRUE(view_of(camera, {8, 8}, Display{}));
}

TEST(Camera, PicturePointsAndPointsInTheAtlasGoBothWays) {
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    const Camera camera{.azimuth_deg = 33, .elevation_deg = -21, .zoom = 2, .projection = projection};
    const View view = *view_of(camera, PictureSize{64, 48}, {0, 1, {5, -6, 7}, 40});
    for (const double depth_mm : {-9.0, 0.0, 12.5}) {
      const Vec3 point = view.point_lps_mm(13.25, 40.5, depth_mm);
      const auto shown = view.picture_point(point);
      ASSERT_TRUE(shown);
      EXPECT_NEAR(shown->x, 13.25, 1e-9);
      EXPECT_NEAR(shown->y, 40.5, 1e-9);
      EXPECT_NEAR(shown->depth_mm, depth_mm, 1e-9);
    }
    const auto middle = view.picture_point({5, -6, 7});
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->x, 32, 1e-12);
    EXPECT_NEAR(middle->y, 24, 1e-12);
  }
}

TEST(Camera, NothingBehindTheEyeHasAPicturePoint) {
  const Camera camera{.projection = CameraProjection::kPerspective};
  const View view = *view_of(camera, PictureSize{64, 48}, {0, 1, {5, -6, 7}, 40});
  EXPECT_FALSE(view.picture_point(view.eye_lps_mm()));
  EXPECT_FALSE(view.picture_point(view.point_lps_mm(3, 4, -2 * *view.eye_mm)));
}

TEST(Camera, RefusesWhatIsNotFiniteOrOutOfRange) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    expect_refused({.azimuth_deg = bad}, {8, 8}, "azimuth");
    expect_refused({.elevation_deg = bad}, {8, 8}, "elevation");
    expect_refused({.zoom = bad}, {8, 8}, "zoom");
    for (const Vec3& center : {Vec3{bad, 0, 0}, {0, bad, 0}, {0, 0, bad}})
      expect_refused({.center_lps_mm = center}, {8, 8}, "centre");
  }
  expect_refused({.center_lps_mm = Vec3{0, 1.1e15, 0}}, {8, 8}, "centre");
  for (const double zoom : {0.0, -1.0, 9e-7, 1.1e6}) expect_refused({.zoom = zoom}, {8, 8}, "zoom");
  for (const PictureSize size : {PictureSize{0, 8}, {8, 0}, {-1, 8}, {32769, 8}, {8, 32769}}) {
    expect_refused({}, size, "picture size");
  }
  EXPECT_TRUE(parallel_view({}, {kMaxPictureSide, kMaxPictureSide}, Display{}).has_value());
}

/// An atlas without structures may declare a bounding ball of radius 0.
TEST(Camera, StandsAnEmptyBall) {
  const auto view = parallel_view({}, {8, 8}, {0, 1, {0, 0, 0}, 0});
  ASSERT_TRUE(view.has_value());
  EXPECT_GT(view->mm_per_pixel, 0);
  EXPECT_TRUE(std::isfinite(view->mm_per_pixel));
}

/// Six blocks, one at each end of the anatomical axes.
TestVolume six_blocks(const Grid& grid) {
  TestVolume volume;
  volume.grid = grid;
  const Affine to_lps = index_to_lps_mm(grid);
  const Vec3 middle =
      to_lps.apply({0.5 * static_cast<double>(grid.size[0] - 1), 0.5 * static_cast<double>(grid.size[1] - 1),
                    0.5 * static_cast<double>(grid.size[2] - 1)});
  const std::pair<const char*, Vec3> kBlocks[] = {{"L", kLeft},      {"R", kRight},    {"A", kAnterior},
                                                  {"P", kPosterior}, {"S", kSuperior}, {"I", kInferior}};
  for (const auto& [name, direction] : kBlocks) {
    volume.structures.push_back(
        {name, make_mask(grid.size, [&, &toward = direction](auto i, auto j, auto k) {
           const Vec3 at = reference::minus(
               to_lps.apply({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}),
               middle);
           const double along = dot(at, toward);
           const double beside = std::sqrt(std::max(0.0, dot(at, at) - along * along));
           return along > 6 && along < 12 && beside < 4;
         })});
  }
  return volume;
}

/// Opacity-weighted centre of a picture, relative to its middle: right and up, in pixels.
std::array<double, 2> shown_at(const Picture& picture) {
  double sum = 0;
  double x_sum = 0;
  double y_sum = 0;
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      const double alpha = picture.at(x, y)[3];
      sum += alpha;
      x_sum += alpha * (x + 0.5 - 0.5 * picture.size.width);
      y_sum += alpha * (0.5 * picture.size.height - y - 0.5);
    }
  }
  EXPECT_GT(sum, 1);
  return {x_sum / sum, y_sum / sum};
}

std::vector<Grid> grids_of_all_kinds() {
  const double c = std::cos(20 * kDegree);
  const double s = std::sin(20 * kDegree);
  return {
      {{28, 28, 28}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
      {{28, 28, 28}, {1, 1, 1}, {9, -8, 7}, {-1, 0, 0, 0, -1, 0, 0, 0, 1}},  // RAS, as in NIfTI
      {{28, 28, 28}, {1, 1, 1}, {9, -8, 7}, {-1, 0, 0, 0, 1, 0, 0, 0, 1}},   // mirrored
      {{14, 28, 9}, {2, 1, 3}, {9, -8, 7}, {0, -1, 0, 0, 0, 1, 1, 0, 0}},    // other axes, anisotropic
      {{32, 34, 16}, {1, 1, 2}, {9, -8, 7}, {c, -s, 0, s, c, 0, 0, 0, 1}},   // oblique
      {{34, 32, 32}, {1, 1, 1}, {9, -8, 7}, {0, -s, c, -1, 0, 0, 0, c, s}},  // oblique, other axes, mirrored
  };
}

/// Each block alone lies in the expected part of the picture, in every named view.
TEST(Camera, EveryNamedViewShowsEveryEndOfTheSubjectWhereItBelongs) {
  const Vec3 kEnds[] = {kLeft, kRight, kAnterior, kPosterior, kSuperior, kInferior};
  int number = 0;
  for (const Grid& grid : grids_of_all_kinds()) {
    const AtlasContent content = make_content(six_blocks(grid));
    Renderer renderer(open_in_memory(content), {1, 0});
    for (std::size_t block = 0; block < 6; ++block) {
      for (const DrawMode mode : {DrawMode::kVolume, DrawMode::kSurface}) {
        Selection selection;
        selection.structures.resize(6);
        selection.structures[block].mode = mode;
        ASSERT_TRUE(renderer.select(selection));
        for (const NamedCase& view : kNamedCases) {
          const auto at = shown_at(render_or_throw(renderer, Camera::of(view.named), {.size = {48, 48}}));
          // Blocks lie 9 mm from the centre; a pixel is about 0.8 mm.
          const std::string told = std::string(view.name) + " view, grid " + std::to_string(number) +
                                   ", block " + content.graph[static_cast<StructureIndex>(block)].id;
          EXPECT_NEAR(at[0] / 10, dot(kEnds[block], view.right), 0.35) << told;
          EXPECT_NEAR(at[1] / 10, dot(kEnds[block], view.up), 0.35) << told;
        }
      }
    }
    ++number;
  }
}

}  // namespace
}  // namespace splatlas
