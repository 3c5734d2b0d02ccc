#include "bench/experiments/axis_switch.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace splatlas {
namespace {

const Display kDisplay{.center_lps_mm = {10, 10, 10}, .radius_mm = 20};

TEST(AxisSwitches, AreBetweenAllPairsOfAxesAMillionthOfARadianOff) {
  const auto switches = axis_switches({.zoom = 3}, {.size = {20, 20, 20}}, kDisplay);
  ASSERT_TRUE(switches);
  std::set<std::pair<Axis, Axis>> pairs;
  for (const AxisSwitch& across : *switches) {
    pairs.insert(std::minmax(across.axis_before, across.axis_after));
    EXPECT_EQ(across.before.zoom, 3);
    const Vec3 before = parallel_view(across.before, {9, 9}, kDisplay)->forward_lps;
    const Vec3 after = parallel_view(across.after, {9, 9}, kDisplay)->forward_lps;
    const double apart = std::hypot(before[0] - after[0], before[1] - after[1], before[2] - after[2]);
    EXPECT_GT(apart, 1e-6) << across.name;
    EXPECT_LT(apart, 2.1e-6) << across.name;
    std::array<double, 3> along{std::abs(before[0]), std::abs(before[1]), std::abs(before[2])};
    std::sort(along.begin(), along.end());
    EXPECT_NEAR(along[1], along[2], 2e-6) << across.name;
    EXPECT_GT(along[0], 0.2) << across.name << ": symmetric views do not pop";
  }
  EXPECT_EQ(pairs.size(), 3u);
}

TEST(AxisSwitches, AreRefusedWhereTheAxisDoesNotSwitch) {
  const auto switches = axis_switches({}, {.size = {20, 20, 20}, .spacing_mm = {1, 1, 2}}, kDisplay);
  ASSERT_FALSE(switches);
  EXPECT_THAT(switches.error().message, testing::HasSubstr("voxels must be cubes"));
}

}  // namespace
}  // namespace splatlas
