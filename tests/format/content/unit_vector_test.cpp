#include "format/content/unit_vector.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

using Float3 = std::array<float, 3>;

double degrees_between(const Float3& a, const Float3& b) {
  const double cx = double{a[1]} * b[2] - double{a[2]} * b[1];
  const double cy = double{a[2]} * b[0] - double{a[0]} * b[2];
  const double cz = double{a[0]} * b[1] - double{a[1]} * b[0];
  const double dot = double{a[0]} * b[0] + double{a[1]} * b[1] + double{a[2]} * b[2];
  return std::atan2(std::hypot(cx, cy, cz), dot) * 180 / std::numbers::pi;
}

TEST(UnitVector, EveryCodeIsAUnitVectorThatPacksToItself) {
  for (unsigned code = 0; code <= 0xffff; ++code) {
    const Float3 n = unpack_normal(static_cast<PackedNormal>(code));
    ASSERT_NEAR(std::hypot(double{n[0]}, double{n[1]}, double{n[2]}), 1, 2e-7) << code;
    ASSERT_LT(degrees_between(unpack_normal(pack_normal(n)), n), 1e-4) << code;
  }
}

/// The code that packing gives for the direction of a code: a positive second coordinate on the seam.
unsigned canonical(unsigned code) {
  int x = static_cast<std::int8_t>(code & 0xff), y = static_cast<std::int8_t>(code >> 8);
  x = std::max(x, -127), y = std::max(y, -127);
  if (std::abs(x) == 127 && std::abs(y) == 127) {
    x = y = 127;
  } else if (std::abs(x) == 127) {
    y = std::abs(y);
  } else if (std::abs(y) == 127) {
    x = std::abs(x);
  }
  return static_cast<unsigned>((x & 0xff) | (y & 0xff) << 8);
}

TEST(UnitVector, PackingInvertsUnpackingExceptForSecondCodesOnTheSeam) {
  int second_codes = 0;
  for (unsigned code = 0; code <= 0xffff; ++code) {
    ASSERT_EQ(pack_normal(unpack_normal(static_cast<PackedNormal>(code))), canonical(code)) << code;
    const bool has_128 = (code & 0xff) == 0x80 || code >> 8 == 0x80;
    second_codes += canonical(code) != code && !has_128;
  }
  EXPECT_EQ(second_codes, 507);
}

TEST(UnitVector, TheSixAxesAreExact) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (const float sign : {-1.0f, 1.0f}) {
      Float3 axis{0, 0, 0};
      axis[a] = sign;
      EXPECT_EQ(unpack_normal(pack_normal(axis)), axis);
    }
  }
}

TEST(UnitVector, LargestErrorIsThatOfThePaper) {
  std::mt19937 random(7);
  std::normal_distribution<float> coordinate;
  double largest = 0;
  for (int n = 0; n < 1'000'000; ++n) {
    const Float3 v{coordinate(random), coordinate(random), coordinate(random)};
    largest = std::max(largest, degrees_between(unpack_normal(pack_normal(v)), v));
  }
  EXPECT_LT(largest, 0.65);  // table 1 of Cigolle et al.: 0.63575 for oct16P
  EXPECT_GT(largest, 0.5);
}

TEST(UnitVector, LengthDoesNotMatter) {
  const Float3 v{0.3f, -0.5f, 0.7f};
  for (const float scale : {1e-30f, 1e-3f, 1e3f, 1e30f}) {
    EXPECT_EQ(pack_normal({v[0] * scale, v[1] * scale, v[2] * scale}), pack_normal(v)) << scale;
  }
}

TEST(UnitVector, NoDirectionPacksAsPlusZ) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Float3 z{0, 0, 1};
  EXPECT_EQ(unpack_normal(pack_normal({0, 0, 0})), z);
  EXPECT_EQ(unpack_normal(pack_normal({kNan, 0, 0})), z);
  EXPECT_EQ(unpack_normal(pack_normal({1, kNan, 0})), z);
  EXPECT_EQ(unpack_normal(pack_normal({0, -1, kNan})), z);
  EXPECT_EQ(unpack_normal(pack_normal({kInfinity, 0, 0})), z);
}

TEST(PackNormals, GivesTheBitsOfPackingOneByOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> component(-1, 1);
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 20000u}) {
    std::vector<std::array<float, 3>> normals(count);
    for (auto& normal : normals) {
      const float scale = std::exp2(60 * component(random));
      for (float& x : normal) x = random() % 8 == 0 ? 0 : scale * component(random);
      if (random() % 16 == 0) normal = unpack_normal(static_cast<PackedNormal>(random()));
      if (random() % 16 == 0) normal = {scale * normal[0], -scale * normal[0], scale * normal[0]};
      if (count < 100 && random() % 64 == 0) normal[1] = std::numeric_limits<float>::infinity();
    }
    std::vector<std::array<float, 3>> expected = normals;
    const std::vector<PackedNormal> packed = pack_normals(normals);
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_EQ(packed[n], pack_normal(normals[n]));
      expected[n] = unpack_normal(packed[n]);
    }
    round_normals(normals);
    EXPECT_EQ(normals, expected) << count;
  }
}

}  // namespace
}  // namespace splatlas
