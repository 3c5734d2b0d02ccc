// Grids of extreme scale and position: pictures depend on shapes, not on millimetres.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reference/picture_difference.h"
#include "tests/support/fails_with.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

TestVolume volume_in(const Grid& grid) {
  TestVolume volume;
  volume.grid = grid;
  const auto in_ball = [&](auto i, auto j, auto k) {
    const double x = (static_cast<double>(i) + 0.5) / static_cast<double>(grid.size[0]) - 0.5;
    const double y = (static_cast<double>(j) + 0.5) / static_cast<double>(grid.size[1]) - 0.5;
    const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(grid.size[2]) - 0.5;
    return x * x + y * y + z * z < 0.2;
  };
  volume.structures = {{"ball", make_mask(grid.size, in_ball), {255, 100, 50}},
                       {"half",
                        make_mask(grid.size, [&](auto i, auto, auto) { return 2 * i < grid.size[0]; }),
                        {50, 100, 255}}};
  return volume;
}

std::vector<Camera> cameras() {
  return {Camera{},
          {.azimuth_deg = 35, .elevation_deg = 20},
          {.azimuth_deg = -160, .elevation_deg = -70},
          Camera::of(NamedView::kSuperior)};
}

TEST(ExtremeGrids, ScaleAndPlaceDoNotShow) {
  const AtlasContent usual = make_content(volume_in({{12, 14, 10}}));
  const Selection selection = selection_of("ball:both(opacity=0.5) + half(opacity=0.2)", usual.graph);
  for (const double mm : {1e-6, 1e-3, 1e3, 1e6}) {
    for (const double away_mm : {0.0, 1e7 * mm}) {
      const AtlasContent content =
          make_content(volume_in({{12, 14, 10}, {mm, mm, mm}, {away_mm, -away_mm, 0.3 * away_mm}}));
      for (const Camera& camera : cameras()) {
        const Picture expected = render_or_throw(usual, selection, camera, {.size = {40, 40}});
        const Picture picture = render_or_throw(content, selection, camera, {.size = {40, 40}});
        // Positions are exact to 1e-16 of the offset, 1e-9 voxels; a vertex seldom snaps to another side.
        EXPECT_LE(reference::difference(picture, expected).largest, 2e-5)
            << mm << " mm, " << away_mm << " mm away, azimuth " << camera.azimuth_deg;
      }
    }
  }
}

/// The centre of the grid is just within reach, that of a structure is not.
TEST(ExtremeGrids, FitsBeyondReachNameTheAtlas) {
  const AtlasContent content = make_content(volume_in({{12, 14, 10}, {4, 4, 4}, {kMaxMm - 22, 0, 0}}));
  Renderer renderer = renderer_of(content, selection_of("ball:both", content.graph));
  EXPECT_TRUE(renderer.render({}, {.size = {20, 20}}));
  int beyond = 0;
  std::vector<Camera> tried = cameras();
  for (Camera camera : cameras()) {
    camera.projection = CameraProjection::kPerspective;
    tried.push_back(camera);
  }
  for (const Camera& camera : tried) {
    const Result<Camera> fitted = renderer.fit(camera, {.size = {20, 20}});
    if (fitted) {
      EXPECT_TRUE(renderer.render(*fitted, {.size = {20, 20}}));
      continue;
    }
    EXPECT_THAT(fitted,
                FailsWith(ErrorCode::kFailed,
                          testing::AllOf(
                              testing::StartsWith(renderer.atlas().name() + ": "),
                              testing::HasSubstr("(1000000000000000."),
                              testing::HasSubstr("more than 1000000000000000 mm from the origin; build"))));
    ++beyond;
  }
  EXPECT_GT(beyond, 0);
}

}  // namespace
}  // namespace splatlas
