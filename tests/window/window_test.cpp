// Player window under mouse and keyboard input.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>

#include "format/atlas_writer.h"
#include "format/content/selection.h"
#include "player/renderer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/file_bytes.h"
#include "tests/support/phantom_content.h"
#include "tests/window/player_session.h"

namespace splatlas {
namespace {

using Json = PlayerSession::Json;
using phantom_structure::kSphere1;
using phantom_structure::kSphere2;

/// Size of the view.
PictureSize size_of(const Json& layout) {
  const Json& view = layout.at("view");
  return {view.at(2).get<int>(), view.at(3).get<int>()};
}

/// A camera as in the log.
Json json_of(const Camera& camera) {
  return {{"azimuth", camera.azimuth_deg},
          {"elevation", camera.elevation_deg},
          {"zoom", camera.zoom},
          {"center_lps_mm", camera.center_lps_mm.value()}};
}

/// The fit of a selection from anterior.
Camera fitted_to(const std::string& text, const PictureSize& size) {
  static const auto atlas = open_in_memory(phantom_content());
  Renderer renderer(atlas, {.threads = 1});
  EXPECT_TRUE(renderer.select(selection_of(text, atlas->graph())));
  return *renderer.fit({}, {.size = size});
}

/// Position of the centre of a ball in the window, from anterior, with everything fitted into the view.
std::array<int, 2> place_of(const phantom::Ball& ball, const Json& layout) {
  static const Display display = phantom_content().display;
  const Json& view = layout.at("view");
  const double x = view.at(0), y = view.at(1);
  const PictureSize size = size_of(layout);
  const auto [i, j, k] = ball.center;
  const Camera camera = fitted_to("*", size);
  const auto shown = view_of(camera, size, display)->picture_point({1.0 * i, 1.0 * j, 1.0 * k});
  return {static_cast<int>(std::lround(x + shown->x)), static_cast<int>(std::lround(y + shown->y))};
}

Selection selection_in(const Json& event) {
  return selection_of(event.at("text").get<std::string>(), phantom_content().graph);
}

class WindowTest : public testing::Test {
 protected:
  void point(std::array<int, 2> place) { screen().point(place[0], place[1]); }
  void click(std::array<int, 2> place) { screen().click(place[0], place[1]); }
  VirtualDisplay& screen() { return player_.display(); }
  std::array<int, 2> sphere(int n) {
    return place_of(phantom::kBalls[static_cast<std::size_t>(n - 1)], player_.layout());
  }
  void enter_selection(const std::string& text) {
    screen().key("ctrl+l");
    screen().key("ctrl+a");
    screen().type(text);
    screen().key("Return");
  }
  /// The window closes without a word.
  void TearDown() override {
    const ProgramResult result = player_.close();
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "");
    player_.wait_for("closed");
  }

  PlayerSession player_;
};

TEST_F(WindowTest, NamesWhatIsUnderThePointerAndShowsItsColor) {
  point(sphere(2));
  Json pointer = player_.wait_for("pointer");
  if (pointer.at("name") == "Sphere_1") pointer = player_.wait_for("pointer");  // it may begin there
  EXPECT_EQ(pointer.at("name"), "Sphere_2");
  point(sphere(1));
  EXPECT_EQ(player_.wait_for("pointer").at("structure"), "Sphere_1");
  const auto [red1, green1, blue1] = screen().pixel(sphere(1)[0], sphere(1)[1]);
  EXPECT_GT(red1, blue1 + 60);  // an orange ball
  const auto [red2, green2, blue2] = screen().pixel(sphere(2)[0], sphere(2)[1]);
  EXPECT_GT(blue2, red2 + 60);  // a blue one
  const Json view = player_.layout().at("view");
  point({view.at(0).get<int>() + 4, view.at(1).get<int>() + 4});
  EXPECT_TRUE(player_.wait_for("pointer").at("structure").is_null());

  click(sphere(1));
  EXPECT_EQ(player_.wait_for("current").at("structure"), "Sphere_1");
}

TEST_F(WindowTest, ModeButtonsChangeTheSelectionAndThePicture) {
  click(player_.place("/rows/Spheres/surface"));
  Selection selection = selection_in(player_.wait_for("selection"));
  EXPECT_EQ(selection.structures[kSphere1].mode, DrawMode::kSurface);
  EXPECT_EQ(selection.structures[kSphere2].mode, DrawMode::kSurface);
  player_.wait_for_final_picture();

  click(player_.place("/rows/Sphere_1/off"));
  const Json event = player_.wait_for("selection");
  selection = selection_in(event);
  EXPECT_EQ(selection.structures[kSphere1].mode, DrawMode::kOff);
  EXPECT_EQ(selection.structures[kSphere2].mode, DrawMode::kSurface);
  EXPECT_EQ(player_.wait_for_final_picture().at("selection"), event.at("text"));
  point(sphere(2));
  player_.wait_for("pointer", [](const Json& e) { return e.at("structure") == "Sphere_2"; });
  EXPECT_THAT(screen().pixel(sphere(1)[0], sphere(1)[1]), testing::ElementsAre(0, 0, 0));

  screen().key("ctrl+z");
  screen().key("ctrl+z");
  EXPECT_EQ(player_.wait_for("selection", [](const Json& e) { return e.at("text") == "*"; }).at("text"), "*");
}

/// On a busy machine, pictures become final during a drag.
TEST_F(WindowTest, TurnsZoomsAndComesBack) {
  const auto wait_for_camera = [&](const auto& holds) {
    return player_
        .wait_for(
            "picture",
            [&](const Json& picture) { return picture.at("final") == true && holds(picture.at("camera")); })
        .at("camera");
  };
  const double zoom = fitted_to("*", size_of(player_.layout())).zoom;
  const auto [x, y] = sphere(1);
  screen().drag({x, y}, {x - 120, y + 60});
  wait_for_camera([](const Json& camera) { return camera.at("azimuth") > 5 && camera.at("elevation") > 2; });

  screen().key("l");
  wait_for_camera(
      [](const Json& camera) { return camera.at("azimuth") == 90 && camera.at("elevation") == 0; });

  screen().xdotool({"click", "4"});  // the wheel
  wait_for_camera([&](const Json& camera) { return camera.at("zoom") > 1.1 * zoom; });
  click(player_.place("/Superior"));
  wait_for_camera(
      [&](const Json& camera) { return camera.at("elevation") == 90 && camera.at("zoom") > 1.1 * zoom; });
  screen().key("Home");
  const Json opened = json_of(fitted_to("*", size_of(player_.layout())));
  wait_for_camera([&](const Json& camera) { return camera == opened; });
}

/// A change of the selection does not move the camera; the button, F and double clicks do.
TEST_F(WindowTest, FitsTheViewToWhatIsAskedFor) {
  const PictureSize size = size_of(player_.layout());
  const auto wait_for_fit = [&](const std::string& text) {
    const Json camera = json_of(fitted_to(text, size));
    player_.wait_for("picture",
                     [&](const Json& e) { return e.at("final") == true && e.at("camera") == camera; });
  };
  enter_selection("Sphere_2");
  player_.wait_for("selection");
  EXPECT_EQ(player_.wait_for_final_picture().at("camera"), json_of(fitted_to("*", size)));
  click(player_.place("/fit"));
  wait_for_fit("Sphere_2");
  screen().key("ctrl+z");
  EXPECT_EQ(player_.wait_for("selection").at("text"), "*");
  EXPECT_EQ(player_.wait_for_final_picture().at("camera"), json_of(fitted_to("Sphere_2", size)));

  const Json& view = player_.layout().at("view");
  click({view.at(0).get<int>() + 4, view.at(1).get<int>() + 4});
  screen().key("f");
  wait_for_fit("*");
  point(sphere(2));
  screen().xdotool({"click", "--repeat", "2", "--delay", "50", "1"});
  EXPECT_EQ(player_.wait_for("current").at("structure"), "Sphere_2");
  wait_for_fit("Sphere_2");
}

TEST_F(WindowTest, TheSelectionTextIsReadAndWritten) {
  enter_selection("sphere_2:both(opacity=0.5)");
  EXPECT_EQ(player_.wait_for("selection").at("text"), "sphere_2:both(opacity=0.5)");
  EXPECT_EQ(player_.wait_for_final_picture().at("selection"), "sphere_2:both(opacity=0.5)");

  click(player_.place("/copy"));
  player_.wait_for("status");
  EXPECT_EQ(screen().clipboard(), "sphere_2:both(opacity=0.5)");

  enter_selection("Sphere_7");
  EXPECT_THAT(player_.wait_for("text_error").at("text"), testing::HasSubstr("Sphere_7"));
}

TEST_F(WindowTest, SearchingLeavesTheRowsThatAreFound) {
  screen().key("slash");
  screen().type("sphere_2");
  player_.wait_for_layout([](const Json& layout) { return layout.at("rows").size() == 1; });
  click(player_.place("/rows/Sphere_2/off"));
  EXPECT_EQ(selection_in(player_.wait_for("selection")).structures[kSphere2].mode, DrawMode::kOff);
}

TEST_F(WindowTest, SavesThePictureBesideTheAtlas) {
  screen().key("ctrl+s");
  const auto saved = [](const Json& e) {
    return e.at("text").get<std::string>().starts_with("Saved") || e.at("error") == true;
  };
  EXPECT_THAT(player_.wait_for("status", saved).at("text"), testing::HasSubstr("phantom-1.png"));
  screen().key("ctrl+s");
  EXPECT_THAT(player_.wait_for("status", saved).at("text"), testing::HasSubstr("phantom-2.png"));
  EXPECT_THAT(player_.folder().names(),
              testing::UnorderedElementsAre("phantom-1.png", "phantom-2.png", "phantom.atlas", "window.log"));
  std::ifstream file(player_.folder().file("phantom-1.png"), std::ios::binary);
  std::string signature(8, '\0');
  file.read(signature.data(), 8);
  EXPECT_EQ(signature, "\x89PNG\r\n\x1a\n");
}

TEST_F(WindowTest, ThePictureFollowsTheWindowsSize) {
  const int before = player_.layout().at("view").at(2);
  screen().resize(1000, 700);
  const Json picture = player_.wait_for(
      "picture", [&](const Json& e) { return e.at("final") == true && e.at("size").at(0) < before; });
  EXPECT_EQ(picture.at("size").at(0), player_.layout().at("view").at(2));
  EXPECT_EQ(picture.at("size").at(1), player_.layout().at("view").at(3));
}

/// As after a render command: the readable parts are shown, and scripts notice the damage.
TEST(WindowOfADamagedAtlas, EndsWithItsStatus) {
  PlayerSession player([](const std::string& atlas) {
    AtlasParts parts = take_apart(encode_atlas(phantom_content()).value());
    const FileLayout layout = lay_out(parts.directory, 0).value();
    parts.chunks[layout.find(SectionKind::kRunsY)->first_chunk].back() ^= std::byte{1};
    write_bytes(atlas, put_together(parts));
  });
  const ProgramResult result = player.close();
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err,
              testing::StartsWith("splatlas-player: phantom.atlas: damaged; was shown without what "
                                  "is missing: "));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
}

TEST(WindowWithoutDisplay, SaysSoInOneLine) {
  const TemporaryFolder folder;
  write_phantom_atlas(folder.file("phantom.atlas"));
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  unsetenv("SDL_VIDEODRIVER");
  const ProgramResult result = run_program({SPLATLAS_PLAYER, "phantom.atlas"}, folder.path());
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err,
            "splatlas-player: cannot open a window: there is no display (DISPLAY is not set); use "
            "'splatlas-player render'\n");
}

TEST(WindowWithoutDisplay, ChecksTheAtlasFirst) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("not_an.atlas")) << "not an atlas";
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const ProgramResult foreign = run_program({SPLATLAS_PLAYER, "not_an.atlas"}, folder.path());
  EXPECT_EQ(foreign.status, 3);
  EXPECT_THAT(foreign.err, testing::HasSubstr("not_an.atlas"));
  EXPECT_EQ(run_program({SPLATLAS_PLAYER, "missing.atlas"}, folder.path()).status, 1);
}

}  // namespace
}  // namespace splatlas
