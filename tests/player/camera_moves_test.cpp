#include "player/camera_moves.h"

#include <random>

#include <gmock/gmock.h>

#include "tests/support/phantom_content.h"

namespace splatlas {
namespace {

const Display kDisplay{.window_low = 0, .window_high = 1, .center_lps_mm = {10, -20, 30}, .radius_mm = 80};
constexpr PictureSize kSize{640, 480};

TEST(CameraMovesTest, TurningKeepsAnglesInRange) {
  EXPECT_DOUBLE_EQ(turned(Camera{.azimuth_deg = 170}, 30, 0).azimuth_deg, -160);
  EXPECT_DOUBLE_EQ(turned(Camera{.elevation_deg = 80}, 0, 30).elevation_deg, 90);
  EXPECT_DOUBLE_EQ(turned(Camera{.azimuth_deg = -170}, -10, -100).azimuth_deg, 180);
  EXPECT_DOUBLE_EQ(turned(Camera{}, 0, -100).elevation_deg, -90);
}

TEST(CameraMovesTest, WhatFacesTheViewerFollowsTheDrag) {
  // A point on the anterior side follows the pointer right and down.
  const Vec3 nose{10, -100, 30};
  const auto place = [&](const Camera& camera) {
    return *view_of(camera, kSize, kDisplay)->picture_point(nose);
  };
  const PicturePoint before = place(Camera{});
  EXPECT_GT(place(turned_by_drag(Camera{}, 20, 0, kSize)).x, before.x + 3);  // a mm is 2.9 pixels
  EXPECT_GT(place(turned_by_drag(Camera{}, 0, 20, kSize)).y, before.y + 3);
  EXPECT_DOUBLE_EQ(turned_by_drag(Camera{}, 480, 0, kSize).azimuth_deg, 180);  // a side of the picture
}

TEST(CameraMovesTest, ZoomingKeepsWhatIsUnderThePointer) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (int n = 0; n < 50; ++n) {
    const Camera camera = turned(Camera{}, 360 * any(random), 180 * any(random) - 90);
    const double x = kSize.width * any(random), y = kSize.height * any(random);
    const Camera nearer = zoomed_at(camera, 0.5 + 2 * any(random), x, y, kSize, kDisplay);
    const Vec3 before = parallel_view(camera, kSize, kDisplay)->point_lps_mm(x, y);
    const Vec3 after = parallel_view(nearer, kSize, kDisplay)->point_lps_mm(x, y);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(before[a], after[a], 1e-9);
  }
}

TEST(CameraMovesTest, ZoomHasLimits) {
  EXPECT_EQ(zoomed_at(Camera{}, 1e9, 320, 240, kSize, kDisplay).zoom, kMaxZoom);
  EXPECT_EQ(zoomed_at(Camera{}, 1e-9, 320, 240, kSize, kDisplay).zoom, kMinZoom);
}

TEST(CameraMovesTest, NoElevationGoesTheWrongWay) {
  EXPECT_EQ(turned(Camera{.elevation_deg = 120}, 10, 5).elevation_deg, 120);
  EXPECT_EQ(turned(Camera{.elevation_deg = 120}, 10, -5).elevation_deg, 115);
  EXPECT_EQ(turned(Camera{.elevation_deg = -120}, 10, -5).elevation_deg, -120);
}

TEST(CameraMovesTest, MovingTakesThePointUnderThePointerAlong) {
  for (const NamedView named : {NamedView::kAnterior, NamedView::kLeft, NamedView::kSuperior}) {
    const Camera camera = Camera::of(named);
    const Camera moved = moved_by_drag(camera, 30, -12, kSize, kDisplay);
    const Vec3 before = parallel_view(camera, kSize, kDisplay)->point_lps_mm(100, 200);
    const Vec3 after = parallel_view(moved, kSize, kDisplay)->point_lps_mm(130, 188);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(before[a], after[a], 1e-9);
  }
}

TEST(CameraMovesTest, LabelsNameGroupsAsAWhole) {
  const auto bearers = [graph = phantom_content().graph](const std::vector<std::string>& names) {
    return value_or_throw(label_bearers(graph, names));
  };
  EXPECT_THAT(bearers({"Spheres", "Sphere_2"}), testing::ElementsAre(0, kNoStructure, 0, 3));
  EXPECT_THAT(bearers({"Spheres/*"}), testing::ElementsAre(kNoStructure, kNoStructure, 2, 3));
}

TEST(CameraMovesTest, BoundingBoxesHoldTheSelectedVoxels) {
  TestVolume volume;
  volume.grid = {{8, 9, 10}, {1, 2, 0.5}, {10, 20, 30}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  volume.structures = {
      {"a", make_mask(volume.grid.size, [](auto i, auto j, auto k) { return i == 2 && j == 3 && k < 4; })},
      {"b", make_mask(volume.grid.size, [](auto i, auto j, auto k) { return i == 7 && j == 8 && k == 9; })}};
  const auto atlas = open_in_memory(make_content(volume));
  const auto of_a = bounding_box(*atlas, selection_of("a", atlas->graph()));
  ASSERT_TRUE(of_a);
  EXPECT_EQ(of_a->first, (Vec3{11.5, 25, 29.75}));
  EXPECT_EQ(of_a->second, (Vec3{12.5, 27, 31.75}));
  const auto of_all = bounding_box(*atlas, selection_of("*:surface", atlas->graph()));
  ASSERT_TRUE(of_all);
  EXPECT_EQ(of_all->second, (Vec3{17.5, 37, 34.75}));
  EXPECT_FALSE(bounding_box(*atlas, Selection{}));
}

}  // namespace
}  // namespace splatlas
