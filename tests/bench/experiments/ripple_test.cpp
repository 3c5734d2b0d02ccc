#include "bench/experiments/ripple.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

/// Footprints add up to one: only float rounding remains.
TEST(Ripple, IsNoneWhereSlicesAreParallelToTheFaces) {
  for (const Quality quality : {Quality::kDraft, Quality::kNormal, Quality::kHigh}) {
    const auto ripple = measure_ripple({.quality = quality, .views = 4});
    ASSERT_TRUE(ripple);
    EXPECT_GE(ripple->pixels, 225u);
    EXPECT_EQ(ripple->pixels + ripple->side_pixels, 3u * 4 * 225 * 2);  // plates, views, pixels, opacities
    EXPECT_LE(ripple->faces_of_slices, 2e-6);
  }
}

/// Slices that cut through the faces sample their slopes: the bench must detect it.
TEST(Ripple, IsDetectedWhereSlicesCutThroughTheFaces) {
  const auto ripple = measure_ripple({.quality = Quality::kNormal, .views = 8});
  ASSERT_TRUE(ripple);
  EXPECT_GE(ripple->side_pixels, 225u);
  EXPECT_GT(ripple->side_faces, 1e-4);
}

}  // namespace
}  // namespace splatlas
