// Cancelled calls of Renderer::render(): they end with kCancelled, and leave no trace in later pictures.
#include <algorithm>
#include <functional>
#include <optional>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/fails_with.h"
#include "tests/support/render.h"
#include "tests/support/repetitions.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

const auto kIsCancelled = FailsWith(ErrorCode::kCancelled, testing::_);

struct FrameCase {
  const char* name;
  Camera camera;
  RenderOptions options;
};

std::vector<FrameCase> frame_cases() {
  RenderOptions options{.size = {40, 30}};
  options.depth_cue = DepthCue::kEdges;
  RenderOptions after = options;
  after.classification = Classification::kAfter;
  const Camera parallel{.azimuth_deg = 33, .elevation_deg = 21};
  Camera perspective = parallel;
  perspective.projection = CameraProjection::kPerspective;
  return {{"sheets", parallel, options}, {"perspective", perspective, options}, {"after", parallel, after}};
}

/// Renders until the n-th report of progress (from 1), then requests a stop.
Result<Frame> render_until(Renderer& renderer, const FrameCase& frame, int n) {
  std::stop_source stop;
  int reports = 0;
  return renderer.render(frame.camera, frame.options, {.stop = stop.get_token(), .progress = [&](double) {
                                                         if (++reports == n) stop.request_stop();
                                                       }});
}

class Cancellation : public testing::TestWithParam<FrameCase> {
 protected:
  [[nodiscard]] Renderer new_renderer(unsigned threads) const {
    return renderer_of(scene_.content, scene_.selection, threads);
  }
  [[nodiscard]] static Frame frame_of(Renderer& renderer) {
    return frame_or_throw(renderer, GetParam().camera, GetParam().options);
  }

  const StandardScene scene_ = hybrid_scene();
};
INSTANTIATE_TEST_SUITE_P(Frames, Cancellation, testing::ValuesIn(frame_cases()),
                         [](const auto& tested) { return std::string(tested.param.name); });

/// At every report of progress: the next picture, its counters and its picks are as without.
TEST_P(Cancellation, LeavesNoTraceInLaterPictures) {
  Renderer untouched = new_renderer(1);
  const Frame expected = frame_of(untouched);
  const auto expected_pick = expected.pick(20.3, 15.2);
  ASSERT_TRUE(expected_pick);
  int n = 1;
  for (;; n += kEveryNth) {
    Renderer renderer = new_renderer(3);
    const Result<Frame> stopped = render_until(renderer, GetParam(), n);
    if (stopped) break;  // all reports have been counted
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled) << stopped.error().message;
    const Frame frame = frame_of(renderer);
    EXPECT_TRUE(frame.missing.empty());
    ASSERT_EQ(frame.picture.rgba, expected.picture.rgba) << n;
    EXPECT_EQ(frame.stats.voxels_visited, expected.stats.voxels_visited);
    EXPECT_EQ(frame.stats.runs_visited, expected.stats.runs_visited);
    EXPECT_EQ(frame.stats.triangles, expected.stats.triangles);
    const auto pick = frame.pick(20.3, 15.2);
    ASSERT_TRUE(pick);
    EXPECT_EQ(pick->structure, expected_pick->structure);
    EXPECT_EQ(pick->point_lps_mm, expected_pick->point_lps_mm);
  }
  EXPECT_GT(n, 11);
}

/// With spans, ray volumes and lighting of another selection and view at hand.
TEST_P(Cancellation, LeavesNoTraceInRenderersThatKeepSomething) {
  const Selection first = selection_of("*:volume(opacity=0.2)", scene_.content.graph);
  Renderer untouched = new_renderer(1);
  const Picture expected = frame_of(untouched).picture;
  Renderer renderer(open_in_memory(scene_.content), {.threads = 3});
  for (int n = 1;; n += kEveryNth) {
    ASSERT_TRUE(renderer.select(first));
    (void)render_or_throw(renderer, Camera{.azimuth_deg = 40}, GetParam().options);
    ASSERT_TRUE(renderer.select(scene_.selection));
    if (render_until(renderer, GetParam(), n)) break;
    ASSERT_EQ(frame_of(renderer).picture.rgba, expected.rgba) << n;
    // The same selection with other lighting, cancelled again.
    (void)render_or_throw(renderer, Camera{.azimuth_deg = -20}, GetParam().options);
    (void)render_until(renderer, GetParam(), n);
    ASSERT_EQ(frame_of(renderer).picture.rgba, expected.rgba) << n;
  }
}

/// Picks of a frame on a coarse grid of pixels.
std::vector<std::optional<std::pair<StructureIndex, Vec3>>> picks_of(const Frame& frame) {
  std::vector<std::optional<std::pair<StructureIndex, Vec3>>> picks;
  for (double y = 0.4; y < 30; y += 3) {
    for (double x = 0.3; x < 40; x += 4) {
      const auto pick = frame.pick(x, y);
      picks.push_back(pick ? std::optional(std::pair(pick->structure, pick->point_lps_mm)) : std::nullopt);
    }
  }
  return picks;
}

/// A picture of another view, quality and path stays on the screen while the next one is cancelled.
TEST_P(Cancellation, LeavesThePictureBeforeToPick) {
  for (FrameCase before : frame_cases()) {
    SCOPED_TRACE(before.name);
    before.camera.azimuth_deg = 60;
    before.options.quality = Quality::kDraft;
    Renderer renderer = new_renderer(2);
    const Frame shown = frame_or_throw(renderer, before.camera, before.options);
    const auto expected = picks_of(shown);
    ASSERT_GT(std::ranges::count_if(expected, [](const auto& pick) { return pick.has_value(); }), 20);
    int n = 0;
    for (; !render_until(renderer, GetParam(), n + 1); n += kEveryNth) {
      ASSERT_EQ(picks_of(shown), expected) << n;
    }
    EXPECT_GT(n, 10);
    EXPECT_NE(picks_of(frame_of(renderer)), expected);
    EXPECT_EQ(picks_of(shown), expected) << "a later frame is finished";
  }
}

TEST_P(Cancellation, ReadsNothingAfterAStop) {
  const auto atlas = open_in_memory(scene_.content);
  Renderer renderer(atlas, {.threads = 2});
  ASSERT_TRUE(renderer.select(scene_.selection));
  const std::uint64_t read = atlas->counters().read;
  std::stop_source stop;
  stop.request_stop();
  const RenderControl control{.stop = stop.get_token(), .progress = {}};
  EXPECT_THAT(renderer.render(GetParam().camera, GetParam().options, control), kIsCancelled);
  EXPECT_THAT(renderer.fit(GetParam().camera, GetParam().options, {}, {}, control), kIsCancelled);
  EXPECT_EQ(atlas->counters().read, read);
}

TEST_P(Cancellation, FromAnotherThreadReturns) {
  Renderer renderer = new_renderer(3);
  std::binary_semaphore started(0), stopped(0);
  std::stop_source stop;
  std::jthread other([&] {
    started.acquire();
    stop.request_stop();
    stopped.release();
  });
  bool waited = false;
  const auto picture = renderer.render(GetParam().camera, GetParam().options,
                                       {.stop = stop.get_token(), .progress = [&](double) {
                                          if (std::exchange(waited, true)) return;
                                          started.release();
                                          stopped.acquire();
                                        }});
  EXPECT_THAT(picture, kIsCancelled);
}

TEST_P(Cancellation, ProgressRisesToOne) {
  Renderer renderer = new_renderer(3);
  for (int frame = 0; frame < 2; ++frame) {
    std::vector<double> reports;
    ASSERT_TRUE(renderer.render(GetParam().camera, GetParam().options,
                                {.stop = {}, .progress = [&](double f) { reports.push_back(f); }}));
    ASSERT_GT(reports.size(), 5u);
    EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end(), std::less_equal<>()));
    EXPECT_GE(reports.front(), 0);
    EXPECT_EQ(reports.back(), 1);
  }
}

}  // namespace
}  // namespace splatlas
