#include "format/content/transfer_curve.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(TransferCurve, ExtinctionReachesTheOpacityOverTheReferenceLength) {
  for (const float opacity : {0.0f, 1e-30f, 1e-4f, 0.5f, kMaxVolumeOpacity}) {
    for (const double length_mm : {1e-6, 0.7, 1e6}) {
      const double extinction = extinction_of(opacity, length_mm);
      EXPECT_NEAR(-std::expm1(-extinction * length_mm), opacity, 1e-15 * static_cast<double>(opacity));
    }
  }
}

/// Triangular opacity with a plateau of shade, for a reference length of half a millimetre.
TEST(TransferCurve, IsLinearInExtinctionAndShadeBetweenPoints) {
  const TransferCurve curve{{{-10, 0, 0.25f}, {10, 0.5f, 1}, {30, 0.75f, 1}}};
  const double ln2 = std::log(2.0);  // opacity 1/2 is ln 2 of depth, 3/4 is 2 ln 2
  struct Expected {
    double grey, extinction, shade;
  };
  for (const auto& [grey, extinction, shade] :
       {Expected{-10, 0, 0.25}, Expected{0, ln2, 0.625}, Expected{5, 1.5 * ln2, 0.8125},
        Expected{10, 2 * ln2, 1}, Expected{15, 2.5 * ln2, 1}, Expected{30, 4 * ln2, 1},
        Expected{-11, 0, 0.25}, Expected{-kInfinity, 0, 0.25}, Expected{kNan, 0, 0.25},
        Expected{31, 4 * ln2, 1}, Expected{kInfinity, 4 * ln2, 1}}) {
    EXPECT_NEAR(evaluate(curve, grey, 0.5).extinction_per_mm, extinction, 1e-14) << grey;
    EXPECT_NEAR(evaluate(curve, grey, 0.5).shade, shade, 1e-15) << grey;
  }
}

TEST(TransferCurve, OnePointIsAConstantAndNoneIsClear) {
  for (const double grey : {-kInfinity, -1e300, 4.0, 5.0, 6.0, kInfinity, kNan}) {
    const TransferValue value = evaluate(TransferCurve{{{5, 0.5f, 0.75f}}}, grey, 1);
    EXPECT_NEAR(value.extinction_per_mm, std::log(2.0), 1e-15);
    EXPECT_EQ(value.shade, 0.75);
    EXPECT_EQ(evaluate(TransferCurve{}, grey, 1).extinction_per_mm, 0);
  }
}

TEST(TransferCurve, AStepMayBeAsNarrowAsTwoNeighboursOfADouble) {
  const double above = std::nextafter(100.0, kInfinity);
  const TransferCurve step{{{100, 0, 0}, {above, 0.5f, 1}}};
  EXPECT_TRUE(check_curve(step));
  EXPECT_EQ(evaluate(step, 100, 1).extinction_per_mm, 0);
  EXPECT_NEAR(evaluate(step, above, 1).extinction_per_mm, std::log(2.0), 1e-15);
}

RC_GTEST_PROP(TransferCurve, StaysBetweenTheNeighbouringPoints, ()) {
  auto random = *random_source();
  const TransferCurve curve = random_curve(random);
  RC_ASSERT(check_curve(curve).has_value());
  for (std::size_t n = 0; n < curve.points.size(); ++n) {
    const TransferPoint& point = curve.points[n];
    RC_ASSERT(evaluate(curve, point.grey, 2).extinction_per_mm == extinction_of(point.opacity, 2));
    if (n == 0) continue;
    const TransferPoint& before = curve.points[n - 1];
    const double t = std::uniform_real_distribution<double>(0, 1)(random);
    const double grey = before.grey + t * (point.grey - before.grey);
    const auto [low, high] = std::minmax({extinction_of(before.opacity, 2), extinction_of(point.opacity, 2)});
    const double found = evaluate(curve, grey, 2).extinction_per_mm;
    RC_ASSERT(found >= low * (1 - 1e-15) && found <= high * (1 + 1e-15));
  }
}

TEST(TransferCurve, RefusesWhatIsNoCurve) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<TransferCurve, const char*>> faults{
      {{}, "no points"},
      {{std::vector<TransferPoint>(257)}, "257 points: at most 256"},
      {{{{kNan, 0}}}, "point 1 of the curve: grey value nan"},
      {{{{0, 0}, {kInfinity, 0}}}, "point 2 of the curve: grey value inf"},
      {{{{-1e308, 0}, {1e308, 0}}}, "point 2 of the curve: grey value 1e+308 is too large"},
      {{{{1, 0}, {1, 0}}}, "grey value 1 must be above 1"},
      {{{{1, 0}, {2, 0}, {1.5, 0}}}, "point 3 of the curve: grey value 1.5 must be above 2"},
      {{{{1, 1.0f}}}, "opacity 1 must be from 0 to 0.9999"},
      {{{{1, -1e-9f}}}, "opacity -1e-09 must be"},
      {{{{1, nan}}}, "opacity nan must be"},
      {{{{1, 0.5f, 1.01f}}}, "shade 1.01 must be from 0 to 1"},
      {{{{1, 0.5f, -0.01f}}}, "shade -0.01 must be"},
      {{{{1, 0.5f, nan}}}, "shade nan must be"},
  };
  for (const auto& [curve, part] : faults) {
    EXPECT_THAT(check_curve(curve), FailsWith(ErrorCode::kUsage, testing::HasSubstr(part))) << part;
  }
}

}  // namespace
}  // namespace splatlas
