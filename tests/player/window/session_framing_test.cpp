// Fit of the view in a session.
#include <gtest/gtest.h>

#include "player/camera_moves.h"
#include "tests/player/window/session_desk.h"

namespace splatlas {
namespace {

using phantom_structure::kSphere2;
using phantom_structure::kSpheres;

using SessionFraming = SessionTest;

/// The camera of Renderer::fit() for these structures of a selection.
Camera fitted_to(const std::string& text, const Camera& direction, std::vector<StructureIndex> part = {}) {
  Renderer renderer(open_in_memory(phantom_content()), {.threads = 1});
  EXPECT_TRUE(renderer.select(selection_of(text, renderer.atlas().graph())));
  const RenderOptions options{.size = kDeskSize};
  return *(part.empty() ? renderer.fit(direction, options) : renderer.fit(direction, options, part));
}

void expect_camera(const Camera& camera, const Camera& expected) {
  EXPECT_EQ(camera.azimuth_deg, expected.azimuth_deg);
  EXPECT_EQ(camera.elevation_deg, expected.elevation_deg);
  EXPECT_EQ(camera.zoom, expected.zoom);
  EXPECT_EQ(camera.center_lps_mm, expected.center_lps_mm);
}

TEST_F(SessionFraming, OpensWithTheSelectionFillingTheView) {
  Desk desk(atlas());
  desk.until_done();
  expect_camera(desk->camera(), fitted_to("*", {}));
  expect_camera(desk->frame()->request.camera, desk->camera());
  EXPECT_GT(desk->camera().zoom, 1);
  EXPECT_EQ(desk->zoom(), 1);
}

TEST_F(SessionFraming, OnlyARequestFramesAnotherSelection) {
  Desk desk(atlas());
  desk.until_done();
  const Camera opened = desk->camera();
  desk->apply_text("Sphere_2");
  desk.until_done();
  expect_camera(desk->camera(), opened);
  desk->set_camera(turned(desk->camera(), 40, 10));
  desk.until_done();
  EXPECT_EQ(desk->camera().zoom, opened.zoom);
  desk->frame_selection();
  desk.until_done();
  expect_camera(desk->camera(), fitted_to("Sphere_2", {.azimuth_deg = 40, .elevation_deg = 10}));
  expect_camera(desk->frame()->request.camera, desk->camera());
  desk->set_camera(zoomed(desk->camera(), 2));
  desk.until_done();
  EXPECT_DOUBLE_EQ(desk->zoom(), 2);
  desk->reset_view();
  desk.until_done();
  expect_camera(desk->camera(), fitted_to("Sphere_2", {}));
}

TEST_F(SessionFraming, FramesTheStructureAtAPoint) {
  Desk desk(atlas());
  desk.until_done();
  const Camera opened = desk->camera();
  desk->frame_at(place_of(phantom::kBalls[1], opened, desk->atlas().display()));
  desk.until([&] { return desk->camera().zoom != opened.zoom && !desk->refining(); });
  expect_camera(desk->camera(), fitted_to("*", {}, {kSphere2}));
  EXPECT_FALSE(desk->current());
  desk->frame_at({0.01, 0.01});  // the background
  desk.until([&] { return desk->camera().zoom == opened.zoom && !desk->refining(); });
  expect_camera(desk->camera(), opened);
  desk->frame_structure(kSpheres);  // a group
  desk.until_done();
  expect_camera(desk->camera(), opened);
}

/// A camera that moves before the answer keeps its direction, and is fitted.
TEST_F(SessionFraming, AFitFollowsTheLatestDirection) {
  Desk desk(atlas());
  for (int n = 0; n < 20; ++n) {
    desk->set_camera(turned(desk->camera(), 1, 0));
    desk->frame_selection();
    desk->update();
  }
  desk.until_done();
  expect_camera(desk->camera(), fitted_to("*", {.azimuth_deg = 20}));
}

}  // namespace
}  // namespace splatlas
