#include "bench/experiments/draw_stress.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(Inspect, CountsPixelsThatAreNoNumbersAndThoseThatShineTooBright) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Picture picture{{3, 2}, {0.1f,  0.2f, 0.3f, 0.4f,      kNan, 0,    0,    kNan,
                                 0,     0,    0,    kInfinity, 0.5f, 0.2f, 0.3f, 0.4f,  // red above alpha
                                 -0.1f, 0,    0,    0.4f,                               // below 0
                                 1,     1,    1,    1.000001f}};                        // rounding
  StressOutcome outcome;
  inspect(picture, outcome);
  EXPECT_EQ(outcome.pixels, 6u);
  EXPECT_EQ(outcome.nan_pixels, 2u);
  EXPECT_EQ(outcome.unphysical, 2u);
}

TEST(DrawStress, DrawsEverySelectionCameraAndOptionAllWays) {
  const TestVolume volume{.grid = {.size = {3, 4, 5}}, .structures = {{"box", std::vector(60, true)}}};
  const Camera broken{.azimuth_deg = std::numeric_limits<double>::quiet_NaN()};
  const StressInput input{
      make_content(volume), {"box:both(opacity=0.5)", "box"}, {{}, broken}, {{.size = {7, 5}}}};
  const StressOutcome outcome = draw_stress(input);
  // 2 selections, 2 cameras, 3 qualities, 2 projections, 2 classifications; half of the cameras are refused.
  EXPECT_EQ(outcome.pictures, 48u);
  EXPECT_EQ(outcome.refused, 24u);
  EXPECT_EQ(outcome.pixels, 24u * 35u);
  EXPECT_EQ(outcome.nan_pixels, 0u);
  EXPECT_EQ(outcome.unphysical, 0u);
}

TEST(StressKinds, AreAllMade) {
  std::set<std::string> names;
  for (const StressKind& kind : stress_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    if (kind.name != std::string("4000 layers")) continue;  // the others are slow to build
    for (const StressInput& input : kind.make()) {
      EXPECT_FALSE(input.selections.empty());
      EXPECT_FALSE(input.cameras.empty());
      EXPECT_FALSE(input.options.empty());
    }
  }
  EXPECT_GE(names.size(), 13u);
  EXPECT_TRUE(names.contains("4000 layers"));
}

}  // namespace
}  // namespace splatlas
