#include "player/window/camera_moves.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

const Display kDisplay{.window_low = 0, .window_high = 1, .center_lps_mm = {10, -20, 30}, .radius_mm = 80};
constexpr PictureSize kSize{640, 480};

TEST(CameraMovesTest, TurningKeepsAnglesInRange) {
  const Camera camera = turned(Camera{.azimuth_deg = 170, .elevation_deg = 80}, 30, 30);
  EXPECT_DOUBLE_EQ(camera.azimuth_deg, -160);
  EXPECT_DOUBLE_EQ(camera.elevation_deg, 90);
  EXPECT_DOUBLE_EQ(turned(Camera{.azimuth_deg = -170}, -10, -100).azimuth_deg, 180);
  EXPECT_DOUBLE_EQ(turned(Camera{}, 0, -100).elevation_deg, -90);
}

TEST(CameraMovesTest, WhatFacesTheViewerFollowsTheDrag) {
  // A point on the anterior side follows the pointer right and down.
  const Vec3 nose{10, -100, 30};
  const auto place = [&](const Camera& camera) {
    const auto view = *parallel_view(camera, kSize, kDisplay);
    double right = 0, up = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      right += (nose[a] - view.center_lps_mm[a]) * view.right_lps[a];
      up += (nose[a] - view.center_lps_mm[a]) * view.up_lps[a];
    }
    return std::pair(right, up);
  };
  const auto [right0, up0] = place(Camera{});
  const auto [right1, up1] = place(turned_by_drag(Camera{}, 20, 0, kSize));
  EXPECT_GT(right1, right0 + 1);
  const auto [right2, up2] = place(turned_by_drag(Camera{}, 0, 20, kSize));
  EXPECT_LT(up2, up0 - 1);
  EXPECT_DOUBLE_EQ(turned_by_drag(Camera{}, 480, 0, kSize).azimuth_deg,
                   180);  // half a turn per picture width
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

TEST(CameraMovesTest, MovingTakesThePointUnderThePointerAlong) {
  for (const NamedView named : {NamedView::kAnterior, NamedView::kLeft, NamedView::kSuperior}) {
    const Camera camera = Camera::of(named);
    const Camera moved = moved_by_drag(camera, 30, -12, kSize, kDisplay);
    const Vec3 before = parallel_view(camera, kSize, kDisplay)->point_lps_mm(100, 200);
    const Vec3 after = parallel_view(moved, kSize, kDisplay)->point_lps_mm(130, 188);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(before[a], after[a], 1e-9);
  }
}

TEST(CameraMovesTest, LettersNameDirectionsInLps) {
  EXPECT_EQ(orientation_letters({1, 0, 0}), "L");
  EXPECT_EQ(orientation_letters({-1, 0, 0}), "R");
  EXPECT_EQ(orientation_letters({0, 1, 0}), "P");
  EXPECT_EQ(orientation_letters({0, -1, 0}), "A");
  EXPECT_EQ(orientation_letters({0, 0, 1}), "S");
  EXPECT_EQ(orientation_letters({0, 0, -1}), "I");
  EXPECT_EQ(orientation_letters({0.8, -0.6, 0}), "LA");
  EXPECT_EQ(orientation_letters({0.6, -0.8, 0}), "AL");
  const double near = std::sin(20 * M_PI / 180);
  EXPECT_EQ(orientation_letters({near, 0, std::sqrt(1 - near * near)}), "S");
}

TEST(CameraMovesTest, EdgesOfTheNamedViews) {
  // Anatomical letters: right, up.
  const std::array<std::pair<NamedView, std::string>, 6> edges{{{NamedView::kAnterior, "LS"},
                                                                {NamedView::kPosterior, "RS"},
                                                                {NamedView::kLeft, "PS"},
                                                                {NamedView::kRight, "AS"},
                                                                {NamedView::kSuperior, "RA"},
                                                                {NamedView::kInferior, "LA"}}};
  for (const auto& [named, letters] : edges) {
    const auto view = *parallel_view(Camera::of(named), kSize, kDisplay);
    EXPECT_EQ(orientation_letters(view.right_lps) + orientation_letters(view.up_lps), letters)
        << title_of(named);
  }
}

TEST(CameraMovesTest, KnowsTheNamedViews) {
  for (const NamedView named : {NamedView::kAnterior, NamedView::kPosterior, NamedView::kLeft,
                                NamedView::kRight, NamedView::kSuperior, NamedView::kInferior}) {
    Camera camera = Camera::of(named);
    camera.zoom = 3;
    EXPECT_EQ(view_of(camera), named);
    EXPECT_EQ(view_of(turned(camera, 360, 0)), named);
    EXPECT_EQ(view_of(turned(camera, 1, 0)), std::nullopt);
  }
}

}  // namespace
}  // namespace splatlas
