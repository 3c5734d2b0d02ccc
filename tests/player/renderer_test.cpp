#include "player/renderer.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/atlas_writer.h"
#include "player/render/frame/frame_renderer.h"
#include "player/render/sheets/spans/span_model.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/fails_with.h"
#include "tests/support/phantom_content.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/repetitions.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

/// Within a tight limit, a new selection drops what earlier ones decoded; the picture is the same.
TEST(Renderer, DropsEarlierSelectionsAboveTheMemoryLimit) {
  TestVolume volume;
  volume.grid.size = {128, 128, 64};
  volume.structures = {{"left", box_mask(volume.grid.size, {4, 4, 4}, {60, 120, 60})},
                       {"right", box_mask(volume.grid.size, {64, 4, 4}, {120, 120, 60})}};
  const AtlasContent content = make_content(volume);
  const auto bytes = value_or_throw(encode_atlas(content));
  const auto decoded_again = [&](std::uint64_t max_memory_bytes, Picture& picture) {
    const auto atlas = *Atlas::open_bytes(bytes);
    Renderer renderer(atlas, {1, max_memory_bytes});
    std::uint64_t before = 0;
    for (const char* text : {"left:surface", "right:surface", "left:surface"}) {
      before = atlas->counters().decoded;
      EXPECT_TRUE(renderer.select(selection_of(text, content.graph)));
      picture = frame_or_throw(renderer, {}, {.size = {64, 64}}).picture;
    }
    return atlas->counters().decoded - before;
  };
  Picture with_room, without;
  EXPECT_EQ(decoded_again(0, with_room), 0u);
  EXPECT_GT(decoded_again(std::uint64_t{8} << 20, without), 0u);
  EXPECT_EQ(with_room.rgba, without.rgba);
}

TEST(Renderer, ReadsNothingOfWhatIsNotSelected) {
  TestVolume volume;
  volume.grid.size = {40, 40, 20};
  std::vector<std::uint16_t> values;
  for (int n = 0; n < 40 * 40 * 20; ++n) values.push_back(static_cast<std::uint16_t>(n * 2654435761u >> 12));
  volume.values = make_values(VoxelType::kUInt16, values);
  volume.window_high = 65535;
  for (int s = 0; s < 16; ++s) {
    const Index3 first{10 * (s % 4), 10 * (s / 4), 0};
    volume.structures.push_back(
        {fmt::format("s{}", s), box_mask(volume.grid.size, first, {first[0] + 9, first[1] + 9, 19})});
  }
  const AtlasContent content = make_content(volume);
  const auto bytes = value_or_throw(encode_atlas(content));
  for (const char* text : {"s5", "s5:surface", "s5:both + s9", "s0 + s15:surface", "*", ""}) {
    const auto atlas = *Atlas::open_bytes(bytes);
    Renderer renderer(atlas, {1, 0});  // several threads may decode a shared chunk twice
    const Selection selection = selection_of(text, content.graph);
    ASSERT_TRUE(renderer.select(selection));
    EXPECT_EQ(atlas->counters().decoded, 0u) << "reading waits for a view";
    (void)render_or_throw(renderer, Camera::of(NamedView::kLeft));

    const auto asked = *Atlas::open_bytes(bytes);
    const DrawPlan plan = asked->tree().plan(selection);
    for (const ClassDraw& draw : plan.classes) {
      if (draw.role == VoxelRole::kSurface) continue;
      (void)asked->read_runs(draw.id, Axis::kZ);  // values use its order
      (void)asked->read_runs(draw.id, Axis::kX);
      (void)asked->read_values(draw.id);
      (void)asked->read_normals(draw.id);
    }
    for (const StructureIndex s : plan.surfaces) (void)asked->read_surface(s);
    EXPECT_EQ(atlas->counters().read, asked->counters().read) << text;
    EXPECT_EQ(atlas->counters().decoded, asked->counters().decoded) << text;
  }
}

/// Spans of the previous selection, and of another renderer, are reused, shaded or not.
TEST(Renderer, GivesTheSameBitsWhateverWasSelectedBefore) {
  std::mt19937 random(1);
  for (std::uint32_t number = 0; number < repetitions(40); ++number) {
    const RandomScene scene = random_scene(number, 16);
    const auto atlas = open_in_memory(scene.content);
    Renderer used(atlas, {2, 0}), other(atlas, {2, 0});
    for (int step = 0; step < 8; ++step) {
      Selection selection = scene.selection;
      for (StructureDraw& draw : selection.structures) {
        if (random() % 4 == 0) draw.mode = DrawMode::kOff;
        if (random() % 4 == 0) draw.opacity = 0.25f;
      }
      ASSERT_TRUE(used.select(selection) && other.select(selection));
      Camera camera = scene.camera;
      RenderOptions options = scene.options;
      for (int frame = 0; frame < 2; ++frame) {
        options.hybrid_shading = random() % 2 == 0;
        if (random() % 3 == 0) camera.azimuth_deg += static_cast<double>(random() % 90);
        const Picture again = render_or_throw(used, camera, options);
        const Picture borrowed = render_or_throw(other, camera, options);
        if (random() % 3 == 0) used.rest();
        const Picture fresh = render_or_throw(scene.content, selection, camera, options);
        ASSERT_EQ(again.rgba, fresh.rgba) << describe(scene) << ", step " << step;
        ASSERT_EQ(borrowed.rgba, fresh.rgba) << describe(scene) << ", step " << step;
      }
    }
  }
}

TEST(Renderer, AnEmptySelectionIsTransparentBlackEverywhere) {
  const AtlasContent content = phantom_content();
  Renderer renderer(open_in_memory(content), {2, 0});
  for (const Selection& next : {Selection{}, selection_of("", content.graph),
                                selection_of("Spheres - Spheres", content.graph), Selection{}}) {
    const Frame frame = frame_or_throw(renderer, {}, {.size = {33, 21}});
    EXPECT_EQ(frame.picture.rgba, std::vector<float>(4 * 33 * 21, 0.0f));
    EXPECT_EQ(frame.stats.voxels_visited, 0u);
    EXPECT_EQ(frame.stats.runs_visited, 0u);
    EXPECT_EQ(frame.stats.triangles, 0u);
    EXPECT_FALSE(frame.pick(16, 10));
    ASSERT_TRUE(renderer.select(next));
  }
}

TEST(Renderer, LooksPastTheAtlas) {
  const AtlasContent content = phantom_content();
  Renderer renderer = renderer_of(content, selection_of("*:both(opacity=0.5)", content.graph));
  for (const double away_mm : {60.0, 1e3, 1e9}) {
    for (const double zoom : {1e-6, 1.0, 1e6}) {
      Camera camera{.azimuth_deg = 20, .zoom = zoom};
      const ParallelView view = *parallel_view(camera, {32, 32}, content.display);
      camera.center_lps_mm = content.display.center_lps_mm;
      for (std::size_t a = 0; a < 3; ++a) (*camera.center_lps_mm)[a] += away_mm * view.right_lps[a];
      const Picture picture = render_or_throw(renderer, camera, {.size = {32, 32}});
      EXPECT_EQ(reference::energy_violation(picture), 0) << away_mm << " mm, zoom " << zoom;
      if (zoom >= 1) {
        EXPECT_EQ(picture.rgba, std::vector<float>(4 * 32 * 32, 0.0f)) << away_mm << " mm, zoom " << zoom;
      }
    }
  }
}

/// The same pixels, ids, depths and picks as with all spans at once. Ids and depths need the ray volume.
TEST(Renderer, DrawsVolumesBeyondItsMemoryInStrips) {
  const AtlasContent content = phantom_content();
  const Selection selection = selection_of("Spheres", content.graph);
  Renderer ample = renderer_of(content, selection);
  Renderer small(open_in_memory(content), {2, std::uint64_t{5} << 18});
  ASSERT_TRUE(small.select(selection));
  for (const Quality quality : {Quality::kDraft, Quality::kNormal}) {
    for (const Camera& camera :
         {Camera{.azimuth_deg = 20, .elevation_deg = 30}, Camera{.azimuth_deg = 100, .zoom = 3},
          Camera{.azimuth_deg = -70, .elevation_deg = -80}}) {
      for (const bool cut : {false, true}) {
        RenderOptions options{.size = {90, 70}, .quality = quality, .ids = true, .depths = true};
        ASSERT_TRUE(!cut || options.cuts.add({{1, 0, 0.3}, 2}));
        const Frame expected = frame_or_throw(ample, camera, options),
                    frame = frame_or_throw(small, camera, options);
        ASSERT_FALSE(expected.stats.strips);
        ASSERT_TRUE(frame.stats.strips);
        EXPECT_EQ(frame.picture.rgba, expected.picture.rgba);
        EXPECT_EQ(frame.ids.numbers, expected.ids.numbers);
        EXPECT_EQ(frame.depths.mm, expected.depths.mm);
        const auto pick = frame.pick(45, 35), same = expected.pick(45, 35);
        ASSERT_EQ(pick.has_value(), same.has_value());
        EXPECT_TRUE(!pick || pick->structure == same->structure);
      }
    }
  }
}

/// Without memory for the ray volume, the depth cue is that of blocks.
TEST(Renderer, RefusesIdsAndDepthsBeyondItsMemory) {
  const AtlasContent content = phantom_content();
  Renderer renderer(open_in_memory(content), {2, std::uint64_t{5} << 16});
  ASSERT_TRUE(renderer.select(selection_of("Spheres", content.graph)));
  RenderOptions options{.size = {90, 70}};
  const Frame plain = frame_or_throw(renderer, {}, options);
  EXPECT_TRUE(plain.stats.strips);
  for (bool RenderOptions::*const asked : {&RenderOptions::ids, &RenderOptions::depths}) {
    options.*asked = true;
    EXPECT_THAT(
        renderer.render({}, options),
        FailsWith(ErrorCode::kLimit, testing::EndsWith("without ids, depth map, outlines and depth cue")));
    options.*asked = false;
    options.depth_cue = DepthCue::kEdges;
    EXPECT_NE(frame_or_throw(renderer, {}, options).picture.rgba, plain.picture.rgba);
    options.depth_cue = DepthCue::kNone;
    EXPECT_EQ(frame_or_throw(renderer, {}, options).picture.rgba, plain.picture.rgba);
  }
}

TEST(Renderer, RefusesPicturesThatNeedTooMuchMemoryBeforeItReads) {
  const AtlasContent content = phantom_content();
  const auto atlas = open_in_memory(content);
  RenderOptions options{.size = {64, 48}};
  // Surfaces only: no memory for volumes.
  const Selection selection = *Selection::parse("Spheres:surface", atlas->graph());
  const std::uint64_t enough = picture_bytes(options.size);
  Renderer too_small(atlas, {1, enough - 1});
  ASSERT_TRUE(too_small.select(selection));
  const std::uint64_t read = atlas->counters().read;
  EXPECT_THAT(too_small.render({}, options), FailsWith(ErrorCode::kLimit, HasSubstr("64x48")));
  EXPECT_EQ(atlas->counters().read, read);
  EXPECT_EQ(atlas->counters().decoded, 0u);

  options.size = {8, 6};
  EXPECT_TRUE(too_small.render({}, options));
  options.size = {32768, 32768};
  EXPECT_FALSE(too_small.render({}, options));
}

/// The picture before a refused frame stays on the screen.
TEST(Renderer, PicksThePictureBeforeAFrameThatWasRefused) {
  const AtlasContent content = phantom_content();
  Renderer renderer(open_in_memory(content), {1, (1200 << 10) + picture_bytes({99, 99})});
  ASSERT_TRUE(renderer.select(selection_of("Spheres:both(opacity=0.5)", content.graph)));
  const Camera far_away{.zoom = 0.05};
  const Frame frame = frame_or_throw(renderer, far_away, {.size = {99, 99}});
  const auto pick = frame.pick(49, 50);
  ASSERT_TRUE(pick);
  EXPECT_FALSE(frame.pick(40, 60));
  const auto refused = renderer.render({}, {.size = {999, 999}});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
  renderer.rest();
  const auto again = frame.pick(49, 50);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->structure, pick->structure);
  EXPECT_EQ(again->point_lps_mm, pick->point_lps_mm);
  EXPECT_FALSE(frame.pick(40, 60));
}

/// A picture whose fragments do not fit into memory is drawn in parts.
TEST(Renderer, DrawsWithMemoryForFewFragments) {
  const AtlasContent content = phantom_content();
  const Camera camera{.azimuth_deg = 30, .elevation_deg = 20, .zoom = 1.5};
  for (const Quality quality : {Quality::kDraft, Quality::kNormal}) {
    for (const bool perspective : {false, true}) {
      RenderOptions options{.size = {601, 299}, .quality = quality, .ids = true, .depths = true};
      Camera of_view = camera;
      if (perspective) of_view.projection = CameraProjection::kPerspective;
      Frame frames[2];
      const std::uint64_t volume = 64 << 20;
      for (const std::size_t n : {0u, 1u}) {
        // Half of the memory is for fragments, of 200 bytes: all of a region, or 60 000
        Renderer renderer(open_in_memory(content), {2, n == 0 ? 4 * volume : (24u << 20)});
        ASSERT_TRUE(renderer.select(selection_of("Spheres:both(opacity=0.5)", content.graph)));
        frames[n] = frame_or_throw(renderer, of_view, options);
      }
      EXPECT_LT(reference::difference(frames[0].picture, frames[1].picture).largest,
                perspective ? 4e-3 : 1e-4);  // rays of a packet share their steps
      EXPECT_EQ(frames[0].ids.numbers, frames[1].ids.numbers);
      EXPECT_EQ(frames[0].depths.mm, frames[1].depths.mm);
    }
  }
}

/// Rims take the numbers of the pixels beside them, from the inside out.
TEST(Renderer, NumbersWhatThePictureShows) {
  Picture picture{{6, 1}, std::vector<float>(24)};
  const float opacities[] = {0.5f, 0.2f, 0.003f, 0.4f, 0.3f, 0.9f};
  for (std::size_t n = 0; n < 6; ++n) picture.rgba[4 * n + 3] = opacities[n];
  IdImage ids{{6, 1}, {0, 0, 8, 0, 0, 7}};
  fit_ids(picture, ids);
  EXPECT_EQ(ids.numbers, (std::vector<StructureNumber>{0, 0, 0, 7, 7, 7}));
}

/// The renderer reuses the memory of a frame: nothing of an earlier id image remains.
TEST(Renderer, IdImagesAreEmptyUnlessAskedFor) {
  const AtlasContent content = phantom_content();
  Renderer renderer = renderer_of(content, selection_of("Spheres", content.graph));
  Frame frame;
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}, .ids = true}, frame));
  const std::vector<StructureNumber> first = frame.ids.numbers;
  EXPECT_FALSE(first.empty());
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}}, frame));
  EXPECT_TRUE(frame.ids.empty());
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}, .ids = true}, frame));
  EXPECT_EQ(frame.ids.numbers, first);
}

TEST(Renderer, FramesEndWithTheirSelection) {
  const AtlasContent content = phantom_content();
  Frame frame, other;
  EXPECT_FALSE(frame.pick(10, 10));
  {
    Renderer renderer = renderer_of(content, selection_of("Spheres:both", content.graph));
    frame = frame_or_throw(renderer, {}, {.size = {20, 20}});
    EXPECT_TRUE(frame.pick(10, 10));
    ASSERT_TRUE(renderer.select(selection_of("Spheres", content.graph)));
    EXPECT_FALSE(frame.pick(10, 10));
    other = frame_or_throw(renderer, {}, {.size = {20, 20}});
    EXPECT_FALSE(frame.pick(10, 10));
    Renderer moved = std::move(renderer);
    EXPECT_TRUE(other.pick(10, 10));
  }
  EXPECT_FALSE(other.pick(10, 10));
}

TEST(Renderer, RefusesInvalidSelectionsAndKeepsTheOldOne) {
  const AtlasContent content = phantom_content();
  Renderer renderer = renderer_of(content, selection_of("Sphere_2:both", content.graph));
  const Frame before = frame_or_throw(renderer, {}, {.size = {20, 20}});
  const auto picks = [&] {
    std::vector<StructureIndex> picked;
    for (int n = 0; n < 400; ++n) {
      const auto pick = before.pick(n % 20 + 0.5, n / 20 + 0.5);
      if (pick) picked.push_back(pick->structure);
    }
    return picked;
  };
  const std::vector<StructureIndex> picks_before = picks();
  ASSERT_FALSE(picks_before.empty());
  const Selection valid = selection_of("*:both", content.graph);
  const auto last = valid.structures.size() - 1;
  Selection invalid = valid;
  invalid.structures[last].opacity = NAN;
  Selection no_points = valid;
  no_points.structures[last].volume.curve = std::make_shared<const TransferCurve>();
  Selection too_long = valid;
  too_long.structures.resize(1000, valid.structures[last]);
  for (const Selection& refused : {invalid, no_points, too_long}) {
    EXPECT_THAT(renderer.select(refused), FailsWith(ErrorCode::kUsage, testing::HasSubstr("selection: ")));
    EXPECT_EQ(picks(), picks_before);
    EXPECT_EQ(render_or_throw(renderer, {}, {.size = {20, 20}}).rgba, before.picture.rgba);
  }
}

/// Early ray termination adds no radiance, takes at most `threshold`, and at least `min_loss` of some value.
void expect_termination(Renderer& renderer, const Camera& camera, RenderOptions options, float threshold,
                        float min_loss) {
  options.termination_threshold = 0;
  const Picture all = render_or_throw(renderer, camera, options);
  options.termination_threshold = threshold;
  const Picture ended = render_or_throw(renderer, camera, options);
  float largest = 0;
  for (std::size_t n = 0; n < all.rgba.size(); ++n) {
    EXPECT_LE(ended.rgba[n], all.rgba[n] + 1e-6f);
    largest = std::max(largest, all.rgba[n] - ended.rgba[n]);
  }
  EXPECT_LE(largest, threshold * 1.0001f);
  EXPECT_GT(largest, min_loss) << "nothing was left out: the test shows nothing";
}

TEST(Renderer, EarlyTerminationOfRaysStaysWithinItsThreshold) {
  const StandardScene scene = phantom_scene();
  Renderer renderer = renderer_of(scene.content, scene.selection);
  const Camera camera{.azimuth_deg = 33, .elevation_deg = 21, .projection = CameraProjection::kPerspective};
  expect_termination(renderer, camera,
                     {.size = {40, 36}, .classification = Classification::kAfter, .hybrid_shading = false},
                     0.05f, 1e-4f);
}

TEST(Renderer, EarlyTerminationOfSheetsStaysWithinItsThreshold) {
  TestVolume volume;
  volume.grid.size = {64, 40, 8};  // whole blocks, and deep
  volume.structures = {{"box", full_mask(volume.grid.size), {200, 180, 90}}};
  const AtlasContent content = make_content(volume);
  Renderer renderer(open_in_memory(content), {1, 0});
  for (const auto& [quality, opacity] :
       {std::pair{Quality::kDraft, "0.2"}, {Quality::kNormal, "0.2"}, {Quality::kDraft, "0.8"}}) {
    SCOPED_TRACE(fmt::format("{}, quality {}", opacity, static_cast<int>(quality)));
    const auto text = fmt::format("box:volume(opacity={})", opacity);
    ASSERT_TRUE(renderer.select(selection_of(text, content.graph)));
    for (const float threshold : {1e-2f, 1e-3f})
      expect_termination(renderer, {}, {.size = {90, 30}, .quality = quality}, threshold, threshold / 100);
  }
}

}  // namespace
}  // namespace splatlas
