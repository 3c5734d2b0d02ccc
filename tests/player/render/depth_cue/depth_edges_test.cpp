#include "player/render/depth_cue/depth_edges.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

constexpr PictureSize kSize{61, 47};
constexpr DepthEdges kEdges{.strength = 0.8f, .radius = 8, .range_mm = 5, .min_mm = 0.25};

/// `mm(x, y)` for every pixel.
template <typename Depth>
DepthMap map_of(const Depth& mm) {
  DepthMap map;
  map.clear(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      map.mm[static_cast<std::size_t>(y * kSize.width + x)] = static_cast<float>(mm(x, y));
    }
  }
  return map;
}

Picture grey_picture() {
  Picture picture{kSize, {}};
  for (int n = 0; n < kSize.width * kSize.height; ++n) {
    for (const float value : {0.5f, 0.25f, 0.125f, 0.75f}) picture.rgba.push_back(value);
  }
  return picture;
}

Picture darkened(const DepthMap& depths, const DepthEdges& edges = kEdges, unsigned threads = 1) {
  Picture picture = grey_picture();
  ThreadPool pool(threads);
  darken_edges(depths, edges, picture, pool);
  return picture;
}

TEST(DepthEdges, APlaneStaysAsItIsAtAnySlantUpToItsBorder) {
  for (const auto& slant : {std::pair(0.0, 0.0), {3.0, 0.0}, {-7.5, 40.0}, {0.01, -0.3}}) {
    const auto plane = [&](int x, int y) { return 100 + slant.first * x + slant.second * y; };
    const DepthMap whole = map_of(plane);
    EXPECT_EQ(darkened(whole).rgba, grey_picture().rgba);
    const DepthMap part = map_of(
        [&](int x, int y) { return x > 20 && x + y < 70 ? plane(x, y) : double{DepthMap::kBackground}; });
    EXPECT_EQ(darkened(part).rgba, grey_picture().rgba);
  }
}

/// At extreme zoom the range is a few of the last digits of depths, which are noise.
TEST(DepthEdges, RoundingOfDepthsDoesNotShow) {
  const DepthMap noisy = map_of([&](int x, int y) { return 200 + 1.5e-5 * ((7 * x + 3 * y) % 5); });
  const DepthEdges edges{.strength = 0.8f, .radius = 8, .range_mm = 1e-4, .min_mm = 1e-4 / 32};
  EXPECT_EQ(darkened(noisy, edges).rgba, grey_picture().rgba);
}

/// Beside a step, pairs across it have a mean half a step nearer.
TEST(DepthEdges, OfAStepTheFurtherSideDarkensByAKnownAmount) {
  for (const double step : {0.4, 2.0, 6.0, 300.0}) {
    const Picture picture = darkened(map_of([&](int x, int) { return x < 30 ? 10.0 : 10.0 + step; }));
    const double share = std::clamp((step / 2 - kEdges.min_mm) / kEdges.range_mm, 0.0, 1.0);
    double before = 0;
    for (int x = 0; x < kSize.width; ++x) {
      const double factor = picture.at(x, 23)[0] / 0.5;
      if (x < 30 || x >= 38 || share == 0) {
        EXPECT_EQ(factor, 1) << x;  // the nearer side, and beyond the radius
        continue;
      }
      // Of the total weight 80, pairs wide enough to reach the step: all but two vertical ones, then two.
      if (x == 30) {
        EXPECT_NEAR(factor, 1 - 0.8 * share * 73 / 80, 1e-6);
      }
      if (x == 37) {
        EXPECT_NEAR(factor, 1 - 0.8 * share * 2 / 80, 1e-6);
      }
      EXPECT_GE(factor, before) << x;
      before = factor;
      EXPECT_EQ(picture.at(x, 23)[3], 0.75f);
      EXPECT_FLOAT_EQ(picture.at(x, 23)[1] * 2, picture.at(x, 23)[0]);
    }
  }
}

/// A furrow and a ridge, sloping on both sides: only the furrow darkens, by the distance of each ring.
TEST(DepthEdges, FurrowsDarkenAndRidgesDoNot) {
  const auto slopes = [](double sign) {
    return map_of([=](int x, int) { return 50 - sign * 2.0 * std::abs(x - 30); });
  };
  EXPECT_EQ(darkened(slopes(-1)).rgba, grey_picture().rgba);
  const Picture furrow = darkened(slopes(1));
  EXPECT_LT(furrow.at(30, 20)[0], 0.25f);
  EXPECT_EQ(furrow.at(30, 20), furrow.at(30, 25));
  EXPECT_EQ(furrow.at(45, 20)[0], 0.5f);
}

TEST(DepthEdges, BackgroundNeitherChangesNorDarkens) {
  const DepthMap island = map_of([](int x, int y) {
    return (x - 30) * (x - 30) + (y - 20) * (y - 20) < 150 ? 70.0 : double{DepthMap::kBackground};
  });
  EXPECT_EQ(darkened(island).rgba, grey_picture().rgba);
  DepthMap empty;
  empty.clear(kSize);
  EXPECT_EQ(darkened(empty).rgba, grey_picture().rgba);
}

TEST(DepthEdges, ThreadsDoNotChangeABitAndNoStrengthChangesNone) {
  const DepthMap bumps =
      map_of([](int x, int y) { return 20 * std::sin(0.3 * x) * std::cos(0.4 * y) + (x * y % 7); });
  const Picture one = darkened(bumps);
  EXPECT_NE(one.rgba, grey_picture().rgba);
  for (const unsigned threads : {2u, 8u}) EXPECT_EQ(darkened(bumps, kEdges, threads).rgba, one.rgba);
  DepthEdges none = kEdges;
  none.strength = 0;
  EXPECT_EQ(darkened(bumps, none).rgba, grey_picture().rgba);
  for (std::size_t n = 0; n < one.rgba.size(); ++n) EXPECT_GE(one.rgba[n], 0.0f);
}

TEST(DepthEdges, FollowThePictureAndTheZoom) {
  ParallelView plane;
  plane.size = {960, 480};
  plane.mm_per_pixel = 0.5;
  const DepthEdges edges = depth_edges(plane, 0.7f);
  EXPECT_DOUBLE_EQ(edges.radius, 10);
  EXPECT_DOUBLE_EQ(edges.range_mm, 2.5);
  plane.mm_per_pixel = 0.05;
  EXPECT_DOUBLE_EQ(depth_edges(plane, 0.7f).range_mm, 0.25);
}

}  // namespace
}  // namespace splatlas
