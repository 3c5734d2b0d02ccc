#include "player/window/session/session.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "format/atlas_writer.h"
#include "player/camera_moves.h"
#include "tests/player/window/session_desk.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using phantom_structure::kSphere1;
using phantom_structure::kSphere2;
using phantom_structure::kSpheres;

constexpr PictureSize kSize = kDeskSize;

bool is_black(const DisplayFrame& frame) {
  return std::all_of(frame.srgb8.begin(), frame.srgb8.end(), [](std::uint8_t byte) { return byte == 0; });
}

TEST_F(SessionTest, ShowsEverythingFirst) {
  Desk desk(atlas());
  EXPECT_EQ(desk->frame(), nullptr);
  desk.until_done();
  const DisplayFrame& frame = *desk->frame();
  EXPECT_EQ(frame.request.text, "*");
  EXPECT_EQ(frame.size, kSize);
  EXPECT_EQ(frame.quality, Quality::kNormal);
  EXPECT_EQ(frame.stats.volume_voxels, 2705u + 1440u + 437u + 464u);
  EXPECT_FALSE(is_black(frame));
}

TEST_F(SessionTest, RendersNothingBeforeTheViewHasASize) {
  Session session(atlas(), {.threads = 1}, [] {});
  session.update();
  EXPECT_FALSE(session.refining());
}

TEST_F(SessionTest, NamesWhatIsUnderThePointer) {
  Desk desk(atlas());
  desk.until_done();
  for (const NamedView view : {NamedView::kAnterior, NamedView::kLeft, NamedView::kSuperior}) {
    desk->turn_to(view);
    for (const StructureIndex s : {kSphere1, kSphere2}) {
      const phantom::Ball& ball = phantom::kBalls[s == kSphere1 ? 0 : 1];
      desk->editor().isolate(s);
      desk->point_at(place_of(ball, desk->camera(), desk->atlas().display()));
      desk.until_done();
      desk.until([&] { return desk->hovered() == s; });
    }
    desk->point_at(ViewPoint{0.01, 0.01});
    desk.until([&] { return !desk->hovered(); });
  }
}

TEST_F(SessionTest, TheNameFollowsTheSelectionUnderARestingPointer) {
  Desk desk(atlas());
  desk.until_done();
  desk->point_at(place_of(phantom::kBalls[0], desk->camera(), desk->atlas().display()));
  desk.until([&] { return desk->hovered() == kSphere1; });
  desk->editor().set_mode(kSphere1, DrawMode::kOff);
  desk.until([&] { return desk->hovered() != kSphere1; });
  desk->editor().undo();
  desk.until([&] { return desk->hovered() == kSphere1; });
  desk->point_at(std::nullopt);
  desk->update();
  EXPECT_EQ(desk->hovered(), std::nullopt);
}

TEST_F(SessionTest, TheLatestOfManyRequestsIsShown) {
  Desk desk(atlas());
  for (int n = 0; n < 100; ++n) {
    desk->set_camera(turned(desk->camera(), 1, 0));
    if (n % 10 == 0) desk->editor().set_mode(kSphere2, static_cast<DrawMode>(n / 10 % 4));
    desk->update();
    EXPECT_TRUE(desk->refining());
  }
  desk.until_done();
  EXPECT_DOUBLE_EQ(desk->frame()->request.camera.azimuth_deg, 100);
  EXPECT_EQ(desk->frame()->request.text, desk->editor().text());
  EXPECT_EQ(*desk->frame()->request.selection, desk->editor().selection());
}

TEST_F(SessionTest, TheDepthCueComesAndGoes) {
  Desk desk(atlas());
  desk.until_done();
  desk->set_camera({.azimuth_deg = 60, .zoom = 2});
  desk.until_done();
  const auto without = desk->frame()->srgb8;
  desk->set_depth_cue(DepthCue::kEdges);
  desk->update();
  EXPECT_TRUE(desk->refining());
  desk.until_done();
  EXPECT_EQ(desk->frame()->request.depth_cue, DepthCue::kEdges);
  EXPECT_NE(desk->frame()->srgb8, without);
  desk->set_depth_cue(DepthCue::kNone);
  desk.until_done();
  EXPECT_EQ(desk->frame()->srgb8, without);
}

TEST_F(SessionTest, AnEmptySelectionIsBlack) {
  Desk desk(atlas());
  desk->editor().hide_all();
  desk.until_done();
  EXPECT_TRUE(is_black(*desk->frame()));
  EXPECT_FALSE(desk->status().error);
}

TEST_F(SessionTest, TellsWhatIsWrongWithTypedText) {
  Desk desk(atlas());
  desk->apply_text("Sphere_9");
  EXPECT_THAT(desk->text_error(), testing::HasSubstr("Sphere_9"));
  EXPECT_EQ(desk->editor().text(), "*");
  desk->apply_text("Large:surface");
  EXPECT_EQ(desk->text_error(), "");
  desk.until_done();
  EXPECT_EQ(desk->frame()->request.text, "Large:surface");
  EXPECT_EQ(desk->frame()->stats.surface_voxels, 1440u);
}

TEST_F(SessionTest, TakesTheRestAndWarnsOfHiddenTerms) {
  Desk desk(atlas());
  desk->apply_text("Sphere_2 + rest:surface(opacity=0.1)");
  EXPECT_EQ(desk->status().text, "");
  desk.until_done();
  EXPECT_EQ(desk->editor().text(), "Sphere_2 + rest:surface(opacity=0.1)");
  EXPECT_EQ(desk->frame()->stats.surface_voxels, 1440u);
  desk->editor().set_opacity(kSphere2, 0.5f);  // writes other text
  EXPECT_EQ(desk->editor().selection().structures[kSphere1].mode, DrawMode::kSurface);
  EXPECT_EQ(desk->editor().selection().structures[kSphere2].opacity, 0.5f);

  desk->apply_text("Sphere_2 + Spheres");
  desk->update();
  EXPECT_EQ(desk->text_error(), "");
  EXPECT_THAT(desk->status().text,
              testing::HasSubstr("warning: selection, column 1: \"Sphere_2\" has no effect"));
  EXPECT_FALSE(desk->status().error);
  desk->apply_text("Spheres");
  desk->update();
  EXPECT_EQ(desk->status().text, "");
}

TEST_F(SessionTest, AnEditTakesTheMessageAboutTheTextAway) {
  Desk desk(atlas());
  desk->apply_text("(");
  EXPECT_NE(desk->text_error(), "");
  desk->editor().isolate(kSphere2);
  desk->update();
  EXPECT_EQ(desk->text_error(), "");
}

TEST_F(SessionTest, ADamagedAtlasIsToldAndTheRestStillPlays) {
  std::vector<std::byte> bytes = *encode_atlas(phantom_content());
  std::size_t offset = 0;
  for (const SectionSize& section : atlas()->sections()) {
    if (section.name == "values") {
      for (std::size_t n = 0; n < section.bytes; ++n) bytes[offset + n] ^= std::byte{0x55};
    }
    offset += section.bytes;
  }
  Desk desk(*Atlas::open_bytes(std::move(bytes), "damaged.atlas"));
  desk.until([&] { return desk->status().error; });
  EXPECT_THAT(desk->status().text, testing::HasSubstr("damaged.atlas"));
  desk->apply_text("*:surface");
  desk.until_done();
  EXPECT_EQ(desk->frame()->request.text, "*:surface");
  EXPECT_FALSE(is_black(*desk->frame()));

  // A selection that cannot be drawn gives way to the latest that could
  desk->apply_text("Sphere_2");
  desk.until([&] { return desk->status().error; });
  EXPECT_EQ(desk->editor().text(), "*:surface");
  EXPECT_FALSE(desk->editor().can_redo());
}

TEST_F(SessionTest, WhatIsDamagedIsToldBesideThePictureOfTheRest) {
  std::vector<std::byte> bytes = *encode_atlas(phantom_content());
  bytes.back() ^= std::byte{1};  // of the last surface
  Desk desk(*Atlas::open_bytes(std::move(bytes), "damaged.atlas"));
  desk->apply_text("*:surface");
  desk.until_done();
  EXPECT_FALSE(is_black(*desk->frame()));
  EXPECT_TRUE(desk->status().error);
  EXPECT_EQ(desk->status().text,
            "\"Sphere_2\": its surface is missing: damaged.atlas: damaged: checksum of surfaces of structure "
            "'Sphere_2'");
  desk->apply_text("Sphere_1:surface");
  desk.until_done();
  EXPECT_EQ(desk->status().text, "");
}

TEST_F(SessionTest, AVolumeInMillilitresFollowsShearedAxes) {
  AtlasContent content = phantom_content();
  content.source_grid.direction_lps = {1, 0.6, 0, 0, 0.8, 0, 0, 0, 1};
  Desk desk(*Atlas::open_bytes(*encode_atlas(content), "sheared.atlas"));
  desk->choose(kSphere1, true);
  EXPECT_DOUBLE_EQ(desk->current()->millilitres, 0.8 * 4.145);
}

TEST_F(SessionTest, ChoosingTellsTheFacts) {
  Desk desk(atlas());
  desk->choose(kSphere1, true);
  EXPECT_EQ(desk->current()->voxels, 2705u + 1440u);
  EXPECT_DOUBLE_EQ(desk->current()->millilitres, 4.145);
  EXPECT_THAT(desk->current()->paths, testing::ElementsAre("Spheres/Sphere_1", "Large/Sphere_1"));
  const auto row = desk->take_revealed_row();
  ASSERT_TRUE(row);
  EXPECT_EQ(desk->rows().rows()[*row].structure, kSphere1);
  EXPECT_EQ(desk->take_revealed_row(), std::nullopt);
  desk->choose(kSpheres, false);
  EXPECT_EQ(desk->current()->voxels, 2705u + 1440u + 437u + 464u);
  desk->choose_nothing();
  EXPECT_FALSE(desk->current());
}

/// Page down and up: from the first scene to the last one, and back.
TEST_F(SessionTest, PlaysTheScenesOfTheAtlas) {
  AtlasContent content = phantom_content();
  content.scenes = {{"Whole", "", "*", 0, 0, 1},
                    {"Sphere", "The small one", "Sphere_2:surface", 90, 10, 0.5},
                    {"Stale", "", "Nothing", 0, 0, 1}};
  Desk desk(open_in_memory(content));
  desk.until_done();
  EXPECT_FALSE(desk->scene());
  desk->show_scene_before();  // the last one, whose structure is missing
  EXPECT_TRUE(desk->status().error);
  EXPECT_THAT(desk->status().text, testing::HasSubstr("scene \"Stale\": "));
  EXPECT_FALSE(desk->scene());
  desk->show_next_scene();
  EXPECT_EQ(desk->scene(), 0u);
  desk->show_next_scene();
  desk.until_done();
  ASSERT_EQ(desk->scene(), 1u);
  const DisplayFrame& frame = *desk->frame();
  EXPECT_EQ(frame.request.text, "Sphere_2:surface");
  EXPECT_EQ(frame.request.camera.azimuth_deg, 90);
  EXPECT_EQ(frame.request.camera.elevation_deg, 10);
  EXPECT_FALSE(is_black(frame));
  const double zoom = desk->camera().zoom;
  desk->frame_selection();
  desk.until([&] { return std::abs(desk->camera().zoom - 2 * zoom) < 1e-9; });
  EXPECT_EQ(desk->scene(), 1u) << "a turned view is still of the scene";
  desk->editor().isolate(kSphere1);
  EXPECT_FALSE(desk->scene()) << "another selection is not";
  desk->show_next_scene();
  EXPECT_EQ(desk->scene(), 0u);
  desk->show_scene_before();
  EXPECT_EQ(desk->scene(), 0u);
}

TEST_F(SessionTest, MayBeClosedAtAnyTime) {
  for (int n = 0; n < 5; ++n) {
    Desk desk(atlas());
    desk->point_at(ViewPoint{0.5, 0.5});
    desk->update();
    if (n % 2 == 0) desk.until([&] { return desk->frame() != nullptr; });
    desk->set_camera(turned({}, 30, 30));
    desk->update();
  }
}

TEST_F(SessionTest, LogsWhatTheUserSees) {
  const TemporaryFolder folder;
  const std::string path = folder.file("log.json");
  {
    Desk desk(atlas(), {.threads = 1}, *SessionLog::to_file(path));
    desk.until_done();
    desk->apply_text("Sphere_2");
    desk.until_done();
    desk->apply_text("nobody");
  }
  std::vector<std::string> events;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const auto json = nlohmann::json::parse(line);
    events.push_back(json.at("event"));
    if (json.at("event") == "picture" && json.at("final") == true) {
      events.push_back(json.at("selection"));
    }
  }
  events.erase(std::unique(events.begin(), events.end()), events.end());
  EXPECT_THAT(events, testing::ElementsAre("selection", "picture", "*", "selection", "picture", "Sphere_2",
                                           "text_error"));
}

TEST(SessionLogTest, RefusesAFileThatCannotBeWritten) {
  const auto log = SessionLog::to_file("/nonexistent/folder/log");
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, ErrorCode::kFailed);
  EXPECT_THAT(log.error().message, testing::HasSubstr("/nonexistent/folder/log"));
}

}  // namespace
}  // namespace splatlas
