#include "player/render/transfer/transfer_table.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/reference/reference_radiance.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename T>
class TransferTableOf : public testing::Test {
 public:
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
TYPED_TEST_SUITE(TransferTableOf, AllTypes);

std::vector<TransferCurve> curves() {
  return {
      TransferCurve{{{20, 0, 0.25f}, {100, 0.3f, 1}}},
      TransferCurve{{{-50.5, 0, 0.25f}, {0.25, 0.9999f, 1}}},
      TransferCurve{{{0, 0, 0}, {1e-3, 0.01f, 1}}},
      TransferCurve{{{-1e9, 0.5f, 0}, {1e9, 0, 1}}},
      TransferCurve{{{59.6, 0, 0.25f}, {60.4, 0.95f, 1}}},                        // a step
      TransferCurve{{{60, 0, 0}, {std::nextafter(60.0, kInfinity), 0.5f, 1}}},    // the steepest
      TransferCurve{{{-20, 0, 0}, {20, 0.5f, 1}, {21, 0.9f, 0.5f}, {99, 0, 0}}},  // a peak
      TransferCurve{{{7, 0.3f, 0.5f}}},                                           // constant
      TransferCurve{{{0, 0, 0.5f}, {50, 0, 1}}},                                  // invisible everywhere
      TransferCurve{{{-3e38, 0, 0.25f}, {3e38, 0.5f, 1}}},
  };
}

TYPED_TEST(TransferTableOf, FollowsTheCurveForEveryValue) {
  const std::vector<TypeParam> values = TestFixture::values();
  const VoxelBuffer buffer = make_values(voxel_type_of<TypeParam>(), values);
  for (const TransferCurve& curve : curves()) {
    const TransferShape shape = shape_of(curve);
    double densest = 0;
    for (const TransferPoint& point : curve.points) {
      densest = std::max(densest, extinction_of(point.opacity, 2));
    }
    for (const bool tabulated : {true, false}) {
      const TransferTable table(shape, buffer.type, tabulated);
      std::vector<ClassifiedVoxel> appearances(values.size());
      table.look_up(buffer.bytes.data(), 0, 1, values.size(), static_cast<float>(densest),
                    appearances.data());
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto grey = static_cast<double>(values[n]);
        const TransferValue expected = reference::transfer(curve, grey, 2);
        // Two floats, rounded and multiplied.
        ASSERT_NEAR(appearances[n].extinction_per_mm, expected.extinction_per_mm,
                    2e-7 * expected.extinction_per_mm + 1e-44)
            << grey;
        ASSERT_NEAR(appearances[n].shade, expected.shade, 6e-8) << grey;
        const TransferValue evaluated = evaluate(curve, grey, 2);
        ASSERT_NEAR(evaluated.extinction_per_mm, expected.extinction_per_mm,
                    1e-14 * expected.extinction_per_mm);
        ASSERT_NEAR(evaluated.shade, expected.shade, 1e-15);
      }
    }
  }
}

TYPED_TEST(TransferTableOf, StridesThroughTheValues) {
  std::vector<TypeParam> values;
  for (int n = 0; n < 100; ++n) values.push_back(static_cast<TypeParam>(n));
  const VoxelBuffer buffer = make_values(voxel_type_of<TypeParam>(), values);
  const TransferShape ramp{{{0, 0, 0}, {100, 1, 1}}};
  for (const bool tabulated : {true, false}) {
    std::vector<ClassifiedVoxel> appearances(9, {-1, -1});
    TransferTable(ramp, buffer.type, tabulated).look_up(buffer.bytes.data(), 5, 12, 8, 2, appearances.data());
    for (std::size_t n = 0; n < 8; ++n) {
      EXPECT_FLOAT_EQ(appearances[n].extinction_per_mm, static_cast<float>(5 + 12 * n) / 50.0f);
      EXPECT_FLOAT_EQ(appearances[n].shade, static_cast<float>(5 + 12 * n) / 100.0f);
    }
    EXPECT_EQ(appearances[8].extinction_per_mm, -1);
  }
}

TEST(TransferTable, IsAtTheLastPointWithoutValues) {
  const TransferShape shape{{{0, 1, 1}, {10, 0.5, 0.25}}};
  std::vector<ClassifiedVoxel> appearances(3, {-1, -1});
  TransferTable(shape, VoxelType::kNone).look_up(nullptr, 7, 3, 3, 4, appearances.data());
  for (const ClassifiedVoxel& appearance : appearances) {
    EXPECT_EQ(appearance.extinction_per_mm, 2);
    EXPECT_EQ(appearance.shade, 0.25f);
  }
}

TEST(TransferShape, IsSharedByVolumesOfDifferentOpacity) {
  EXPECT_EQ(shape_of({{{0, 0, 0.25f}, {5, 0.1f}}}), shape_of({{{0, 0, 0.25f}, {5, 0.9999f}}}));
  EXPECT_NE(shape_of({{{0, 0, 0.25f}, {5, 0.1f}}}), shape_of({{{0, 0, 0.5f}, {5, 0.1f}}}));
  const TransferShape peak = shape_of({{{0, 0.5f}, {5, 0.75f}, {6, 0}}});
  EXPECT_NEAR(peak.points[0].extinction, 0.5, 1e-15);  // ln 2 and 2 ln 2
  EXPECT_EQ(peak.points[1].extinction, 1);
  EXPECT_EQ(peak.points[2].extinction, 0);
}

}  // namespace
}  // namespace splatlas
