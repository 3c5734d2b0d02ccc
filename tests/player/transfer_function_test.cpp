#include "player/transfer_function.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Display kDisplay{.window_low = 20, .window_high = 220, .center_lps_mm = {}, .radius_mm = 1};

StructureDraw styled(const VolumeStyle& style, std::optional<float> opacity = std::nullopt) {
  StructureDraw draw;
  draw.mode = DrawMode::kVolume;
  draw.opacity = opacity;
  draw.volume = style;
  return draw;
}

VolumeStyle ramp(std::optional<double> low, std::optional<double> high,
                 TransferProfile profile = TransferProfile::kSoft) {
  return {.profile = profile, .low = low, .high = high, .curve = nullptr};
}

VolumeStyle curve(std::vector<TransferPoint> points) {
  return {.curve = std::make_shared<const TransferCurve>(TransferCurve{std::move(points)})};
}

using Points = std::vector<TransferPoint>;

Points points_of(const VolumeStyle& style, std::optional<float> opacity = std::nullopt) {
  return transfer_curve(styled(style, opacity), kDisplay).points;
}

TEST(TransferFunction, RampsOverTheDisplayWindowByDefault) {
  EXPECT_EQ(transfer_curve({}, kDisplay).points, (Points{{20, 0, 0.25f}, {220, 0.3f, 1}}));
  EXPECT_EQ(points_of({}, 0.5f), (Points{{20, 0, 0.25f}, {220, 0.5f, 1}}));
  EXPECT_EQ(points_of({}, 1.0f), (Points{{20, 0, 0.25f}, {220, kMaxVolumeOpacity, 1}}));
}

TEST(TransferFunction, ThinIsTheSameRampAllButClear) {
  const VolumeStyle thin = ramp({}, {}, TransferProfile::kThin);
  EXPECT_EQ(points_of(thin), (Points{{20, 0, 0.25f}, {220, 0.01f, 1}}));
  EXPECT_EQ(points_of(thin, 0.02f), (Points{{20, 0, 0.25f}, {220, 0.02f, 1}}));
}

TEST(TransferFunction, HardIsAStepInTheMiddleWithFullShadeAboveIt) {
  const TransferCurve step = transfer_curve(styled(ramp({}, {}, TransferProfile::kHard)), kDisplay);
  ASSERT_EQ(step.points.size(), 4u);
  EXPECT_EQ(step.points[0], (TransferPoint{20, 0, 0.25f}));
  EXPECT_NEAR(step.points[1].grey, 119, 1e-12);
  EXPECT_EQ(step.points[1].opacity, 0);
  EXPECT_NEAR(step.points[2].grey, 121, 1e-12);
  EXPECT_EQ(step.points[2].opacity, 0.95f);
  EXPECT_EQ(step.points[3], (TransferPoint{220, 0.95f, 1}));
  for (const double grey : {0.0, 20.0, 70.0, 119.5, 120.0, 180.0, 220.0, 300.0}) {
    if (grey > 119) {
      EXPECT_EQ(evaluate(step, grey, 1).shade, 1) << grey;
    }
    const double extinction = grey < 120 ? 0 : extinction_of(0.95f, 1);
    if (std::abs(grey - 120) > 1) {
      EXPECT_NEAR(evaluate(step, grey, 1).extinction_per_mm, extinction, 1e-15 * extinction) << grey;
    }
  }
  EXPECT_NEAR(evaluate(step, 120, 1).extinction_per_mm, 0.5 * extinction_of(0.95f, 1), 1e-12);
}

TEST(TransferFunction, EndsThatAreLeftOpenAreTheWindows) {
  EXPECT_EQ(points_of(ramp(50, {})), (Points{{50, 0, 0.25f}, {220, 0.3f, 1}}));
  EXPECT_EQ(points_of(ramp({}, 50)), (Points{{20, 0, 0.25f}, {50, 0.3f, 1}}));
  EXPECT_EQ(points_of(ramp(-5, 5)), (Points{{-5, 0, 0.25f}, {5, 0.3f, 1}}));
}

TEST(TransferFunction, RampsBeyondTheWindowAreAsWide) {
  EXPECT_EQ(points_of(ramp(300, {})), (Points{{300, 0, 0.25f}, {500, 0.3f, 1}}));
  EXPECT_EQ(points_of(ramp(220, {})), (Points{{220, 0, 0.25f}, {420, 0.3f, 1}}));
  EXPECT_EQ(points_of(ramp({}, -7)), (Points{{-207, 0, 0.25f}, {-7, 0.3f, 1}}));
  // A window lost in rounding becomes a step.
  const TransferCurve step = transfer_curve(styled(ramp(1e300, {}, TransferProfile::kHard)), kDisplay);
  ASSERT_EQ(step.points.size(), 2u);
  EXPECT_EQ(step.points[0].grey, 1e300);
  EXPECT_EQ(step.points[1].grey, std::nextafter(1e300, kInfinity));
}

TEST(TransferFunction, IsFullEverywhereWithoutAWindow) {
  for (const auto& [low, high] : {std::pair(5.0, 5.0),
                                  {6.0, 5.0},
                                  {kNan, 5.0},
                                  {5.0, kNan},
                                  {-kInfinity, 5.0},
                                  {5.0, kInfinity},
                                  {-1e308, 1e308}}) {
    const Display display{.window_low = low, .window_high = high, .center_lps_mm = {}, .radius_mm = 1};
    const TransferCurve full = transfer_curve(styled({}, 0.5f), display);
    EXPECT_EQ(full.points, (Points{{0, 0.5f, 1}})) << low << ".." << high;
  }
}

TEST(TransferFunction, AnOpacityScalesACurve) {
  const Points points{{0, 0}, {1, 0.5f, 0.5f}, {2, 0.75f}};  // depths 0, ln 2, 2 ln 2
  const Points scaled = points_of(curve(points), 0.9375f);
  ASSERT_EQ(scaled.size(), 3u);  // depths twice as large
  EXPECT_EQ(scaled[0], points[0]);
  EXPECT_NEAR(scaled[1].opacity, 0.75, 1e-7);
  EXPECT_EQ(scaled[1].shade, 0.5f);
  EXPECT_EQ(scaled[2].opacity, 0.9375f);
  const Points clear{{0, 0}, {1, 0}};
  EXPECT_EQ(points_of(curve(clear), 0.5f), clear);
  EXPECT_EQ(full_opacity(styled(curve(clear), 0.5f)), 0);
}

RC_GTEST_PROP(TransferFunction, IsACurveThatReachesTheFullOpacity, ()) {
  auto random = *random_source();
  StructureDraw draw = styled(random_style(random));
  if (random() % 2 == 0) draw.opacity = std::vector{1e-30f, 0.01f, 0.5f, 1.0f}[random() % 4];
  const double low = std::uniform_real_distribution<double>(-1e3, 1e3)(random);
  const Display display{.window_low = low,
                        .window_high = low + (random() % 4 == 0 ? 0 : 1e-3 + static_cast<double>(random())),
                        .center_lps_mm = {},
                        .radius_mm = 1};
  const TransferCurve found = transfer_curve(draw, display);
  const auto checked = check_curve(found);
  if (!checked) RC_FAIL(checked.error().message);
  float densest = 0;
  for (const TransferPoint& point : found.points) densest = std::max(densest, point.opacity);
  RC_ASSERT(densest == full_opacity(draw));
}

}  // namespace
}  // namespace splatlas
