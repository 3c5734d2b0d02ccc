#include "player/transfer_function.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/reference/reference_light.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

template <typename T>
class GreyRampOf : public testing::Test {
 public:
  static constexpr VoxelType type() {
    if constexpr (std::is_same_v<T, std::uint8_t>) return VoxelType::kUInt8;
    if constexpr (std::is_same_v<T, std::int8_t>) return VoxelType::kInt8;
    if constexpr (std::is_same_v<T, std::uint16_t>) return VoxelType::kUInt16;
    if constexpr (std::is_same_v<T, std::int16_t>) return VoxelType::kInt16;
    if constexpr (std::is_same_v<T, std::uint32_t>) return VoxelType::kUInt32;
    if constexpr (std::is_same_v<T, std::int32_t>) return VoxelType::kInt32;
    if constexpr (std::is_same_v<T, float>) return VoxelType::kFloat32;
    return VoxelType::kFloat64;
  }
  /// Every value of small types; limits and values around the window of large ones.
  static std::vector<T> values() {
    using Limits = std::numeric_limits<T>;
    std::vector<T> all;
    if constexpr (sizeof(T) <= 2) {
      for (long v = Limits::lowest(); v <= Limits::max(); ++v) all.push_back(static_cast<T>(v));
    } else {
      all = {Limits::lowest(), Limits::min(), Limits::max(), T{0}, T{1}, T{19}, T{20}, T{21}, T{60}, T{99},
             T{100},           T{101}};
      if constexpr (std::is_floating_point_v<T>) {
        for (const T v : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), Limits::denorm_min(),
                          T{33.25}, T{-1e30f}}) {
          all.push_back(v);
        }
      }
    }
    return all;
  }
};

using AllTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                std::int32_t, float, double>;
TYPED_TEST_SUITE(GreyRampOf, AllTypes);

TYPED_TEST(GreyRampOf, FollowsTheRampForEveryValue) {
  const std::vector<TypeParam> values = TestFixture::values();
  const VoxelBuffer buffer = make_values(TestFixture::type(), values);
  for (const auto& [low, high] : {std::pair(20.0, 100.0), {-50.5, 0.25}, {0.0, 1e-3}, {-1e9, 1e9}}) {
    const GreyRamp ramp(buffer.type, low, high);
    std::vector<float> positions(values.size());
    ramp.positions(buffer.bytes.data(), 0, 1, values.size(), positions.data());
    for (std::size_t n = 0; n < values.size(); ++n) {
      const double expected = reference::ramp_position(static_cast<double>(values[n]), low, high);
      ASSERT_NEAR(positions[n], expected, 6e-8) << +values[n] << " in " << low << ".." << high;
      ASSERT_EQ(positions[n], ramp.position_of(static_cast<double>(values[n])));
    }
  }
}

TYPED_TEST(GreyRampOf, StridesThroughTheValues) {
  std::vector<TypeParam> values;
  for (int n = 0; n < 100; ++n) values.push_back(static_cast<TypeParam>(n));
  const VoxelBuffer buffer = make_values(TestFixture::type(), values);
  const GreyRamp ramp(buffer.type, 0, 100);
  std::vector<float> positions(9, -1);
  ramp.positions(buffer.bytes.data(), 5, 12, 8, positions.data());
  for (std::size_t n = 0; n < 8; ++n) EXPECT_FLOAT_EQ(positions[n], static_cast<float>(5 + 12 * n) / 100.0f);
  EXPECT_EQ(positions[8], -1);
}

TYPED_TEST(GreyRampOf, IsFullEverywhereWithoutAWindow) {
  const std::vector<TypeParam> values = TestFixture::values();
  const VoxelBuffer buffer = make_values(TestFixture::type(), values);
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [low, high] : {std::pair(5.0, 5.0),
                                  {6.0, 5.0},
                                  {nan, 5.0},
                                  {5.0, nan},
                                  {-infinity, 5.0},
                                  {5.0, infinity},
                                  {-1e308, 1e308}}) {
    const GreyRamp ramp(buffer.type, low, high);
    std::vector<float> positions(values.size());
    ramp.positions(buffer.bytes.data(), 0, 1, values.size(), positions.data());
    for (const float position : positions) ASSERT_EQ(position, 1.0f) << low << ".." << high;
  }
}

TEST(GreyRamp, IsFullWithoutValues) {
  std::vector<float> positions(3, -1);
  GreyRamp(VoxelType::kNone, 0, 1).positions(nullptr, 7, 3, 3, positions.data());
  EXPECT_EQ(positions, (std::vector<float>{1, 1, 1}));
}

TEST(VolumeLook, ReachesItsOpacityOverTheReferenceLength) {
  StructureDraw draw;
  draw.color = {255, 128, 0};
  for (const float opacity : {1e-8f, 1e-4f, 0.1f, 0.5f, 0.999f}) {
    for (const double length_mm : {1e-6, 0.7, 1.0, 1e6}) {
      draw.opacity = opacity;
      const VolumeLook look = volume_look(draw, length_mm);
      const double depth = look.extinction_per_mm * length_mm;
      // The float extinction rounds the depth by 6e-8 of itself.
      EXPECT_NEAR(-std::expm1(-depth) / static_cast<double>(opacity), 1, 2e-7)
          << opacity << ", " << length_mm;
    }
  }
}

TEST(VolumeLook, HasADefaultAndAFiniteLimit) {
  StructureDraw draw;
  EXPECT_FLOAT_EQ(volume_look(draw, 2.0).extinction_per_mm, static_cast<float>(-std::log(0.7) / 2));
  draw.opacity = 1.0f;
  const VolumeLook look = volume_look(draw, 1.0);
  EXPECT_NEAR(look.extinction_per_mm, -std::log1p(-0.9999), 1e-3);
}

TEST(VolumeLook, ColorsAreLinearLight) {
  for (int channel = 0; channel < 256; ++channel) {
    StructureDraw draw;
    draw.color = {static_cast<std::uint8_t>(channel), 0, 255};
    const VolumeLook look = volume_look(draw, 1.0);
    EXPECT_NEAR(look.color[0], reference::linear_of(draw.color)[0], 1e-7);
    EXPECT_EQ(look.color[1], 0.0f);
    EXPECT_EQ(look.color[2], 1.0f);
  }
}

TEST(VolumeLook, ShadeRunsFromTheDarkestToOne) {
  EXPECT_FLOAT_EQ(shade_of(0), kDarkestShade);
  EXPECT_FLOAT_EQ(shade_of(1), 1.0f);
  EXPECT_FLOAT_EQ(shade_of(0.5f), 0.625f);
}

}  // namespace
}  // namespace splatlas
