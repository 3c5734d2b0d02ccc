#include "bench/frames.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(BitsDiffer, ComparesBitsNotValues) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::array a{1.0f, 0.0f, kNan, 2.0f};
  EXPECT_EQ(bits_differ(a, a), 0u);
  const std::array b{1.0f, -0.0f, kNan, std::nextafter(2.0f, 3.0f)};
  EXPECT_EQ(bits_differ(a, b), 2u);
}

TEST(BitsDiffer, CountsAllWhereLengthsDiffer) {
  const std::array a{1.0f, 2.0f, 3.0f};
  EXPECT_EQ(bits_differ(a, std::span(a).first(2)), 3u);
  EXPECT_EQ(bits_differ({}, {}), 0u);
}

}  // namespace
}  // namespace splatlas
