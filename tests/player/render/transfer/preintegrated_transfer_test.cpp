#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "player/render/transfer/transfer_table.h"

namespace splatlas {
namespace {

constexpr double kLength = 1.5;  // reference length, mm

TransferCurve random_curve(std::mt19937& random, std::size_t points) {
  std::uniform_real_distribution<double> step(0.5, 20);
  std::uniform_real_distribution<float> share(0, 1);
  TransferCurve curve;
  double grey = 10;
  for (std::size_t n = 0; n < points; ++n) {
    curve.points.push_back({grey, n == 0 ? 0.0f : 0.9f * share(random), share(random)});
    grey += step(random);
  }
  return curve;
}

std::size_t segment_of(const PreintegratedTransfer& curve, double grey) {
  std::size_t segment = 0;
  while (segment < curve.points() && grey >= curve.row(PreintegratedTransfer::kGrey)[segment + 1]) ++segment;
  return segment;
}

/// Rows and segments, up to this one, that are not finite.
std::size_t infinities(const PreintegratedTransfer& transfer, std::size_t last_segment) {
  std::size_t count = 0;
  for (std::size_t row = 0; row < PreintegratedTransfer::kRows; ++row) {
    const float* const values = transfer.row(static_cast<PreintegratedTransfer::Row>(row));
    count += static_cast<std::size_t>(
        std::count_if(values, values + last_segment + 1, [](float value) { return !std::isfinite(value); }));
  }
  return count;
}

TEST(PreintegratedTransfer, EverySegmentIsTheCurve) {
  std::mt19937 random(1);
  for (const std::size_t points : {1u, 2u, 5u, 16u, 256u}) {
    const TransferCurve curve = random_curve(random, points);
    const PreintegratedTransfer prepared(curve, {.bytes = true}, kLength);
    ASSERT_EQ(prepared.points(), points);
    const double last = curve.points.back().grey;
    double steepest = 0;  // factor of rounding of grey values to floats
    for (std::size_t s = 0; s <= points; ++s) {
      steepest =
          std::max({steepest, std::abs(double{prepared.row(PreintegratedTransfer::kExtinctionSlope)[s]}),
                    std::abs(double{prepared.row(PreintegratedTransfer::kShadeSlope)[s]})});
    }
    const double rounding = 1e-6 + 6e-8 * last * steepest;
    for (int n = 0; n < 1000; ++n) {
      const double grey = (last + 20) * n / 1000;
      const std::size_t s = segment_of(prepared, grey);
      const double above = grey - prepared.row(PreintegratedTransfer::kGrey)[s];
      const TransferValue expected = evaluate(curve, grey, kLength);
      EXPECT_NEAR(prepared.row(PreintegratedTransfer::kExtinction)[s] +
                      above * prepared.row(PreintegratedTransfer::kExtinctionSlope)[s],
                  expected.extinction_per_mm, rounding);
      EXPECT_NEAR(prepared.row(PreintegratedTransfer::kShade)[s] +
                      above * prepared.row(PreintegratedTransfer::kShadeSlope)[s],
                  expected.shade, rounding);
    }
  }
}

// Found by fuzzing: 255 over the minimum width is infinite, and so is a float of the maximum width.
TEST(PreintegratedTransfer, IsFiniteAtEveryWidth) {
  for (const double width : {5e-324, 1e-310, 1e-300, 1e-30, 1.0, 1e30, 1e300}) {
    for (const double low : {0.0, -width, 7.0, -1e300}) {
      const double high = std::max(low + width, std::nextafter(low, 1e308));
      const TransferCurve curve{{{low, 0, 0}, {high, 0.9f, 1}}};
      for (const VoxelType type : {VoxelType::kUInt8, VoxelType::kFloat64}) {
        const auto scale = grey_scale(curve, type);
        ASSERT_TRUE(scale);
        EXPECT_EQ(scale->stored(0), -scale->offset * scale->scale);
        const PreintegratedTransfer prepared(curve, *scale, 1e-6);
        EXPECT_EQ(infinities(prepared, prepared.points()), 0u) << low << " to " << high;
      }
    }
  }
}

TEST(PreintegratedTransfer, RampsThatAreTooNarrowForFloatsAreSteps) {
  const TransferCurve curve{{{0, 0, 0.25f}, {4e-44, 0, 0.5f}, {5e-44, 0.5f, 0.5f}, {255, 0.5f, 0.5f}}};
  const PreintegratedTransfer prepared(curve, *grey_scale(curve, VoxelType::kUInt8), 1e-9);
  EXPECT_EQ(infinities(prepared, prepared.points()), 0u);
  EXPECT_FALSE(prepared.shows(0, 0));
  EXPECT_EQ(prepared.row(PreintegratedTransfer::kExtinction)[3],
            static_cast<float>(extinction_of(0.5f, 1e-9)));
}

TEST(PreintegratedTransfer, IsFiniteForAPointFarAway) {
  for (const double grey : {-7e278, 1e300}) {
    const TransferCurve curve{{{grey, 0, 0}}};
    const auto scale = grey_scale(curve, VoxelType::kInt16);
    ASSERT_TRUE(scale);
    const PreintegratedTransfer prepared(curve, *scale, 1);
    EXPECT_NEAR(prepared.row(PreintegratedTransfer::kGrey)[1], std::copysign(1e5, grey), 1);
    EXPECT_FALSE(prepared.shows(-1e5f, 1e5f));
  }
}

TEST(PreintegratedTransfer, IntegralsAreSumsOverGreyValues) {
  std::mt19937 random(2);
  const TransferCurve curve = random_curve(random, 9);
  const PreintegratedTransfer prepared(curve, {.bytes = true}, kLength);
  double depth = 0, emission = 0, variation = 0;
  constexpr int kSteps = 20000;
  for (std::size_t p = 1; p < curve.points.size(); ++p) {
    const double from = curve.points[p - 1].grey, width = curve.points[p].grey - from;
    for (int n = 0; n < kSteps; ++n) {
      const TransferValue value = evaluate(curve, from + width * (n + 0.5) / kSteps, kLength);
      depth += width / kSteps * value.extinction_per_mm;
      emission += width / kSteps * value.extinction_per_mm * value.shade;
    }
    variation += std::abs(evaluate(curve, from + width, kLength).extinction_per_mm -
                          evaluate(curve, from, kLength).extinction_per_mm);
    EXPECT_NEAR(prepared.row(PreintegratedTransfer::kDepth)[p + 1], depth, 1e-6 * (1 + depth));
    EXPECT_NEAR(prepared.row(PreintegratedTransfer::kEmission)[p + 1], emission, 1e-6 * (1 + emission));
    EXPECT_NEAR(prepared.row(PreintegratedTransfer::kVariation)[p + 1], variation, 1e-5);
  }
  EXPECT_NEAR(prepared.variation(), variation, 1e-5);
}

TEST(PreintegratedTransfer, TellsWhereItShows) {
  const TransferCurve curve{{{10, 0, 1}, {20, 0, 1}, {30, 0.5f, 1}, {40, 0, 1}, {50, 0, 1}}};
  const PreintegratedTransfer prepared(curve, {.bytes = true}, kLength);
  EXPECT_FALSE(prepared.shows(0, 20));
  EXPECT_TRUE(prepared.shows(0, 21));
  EXPECT_TRUE(prepared.shows(22, 23));
  EXPECT_TRUE(prepared.shows(0, 255));  // visible values lie in between
  EXPECT_FALSE(prepared.shows(40, 255));
  EXPECT_TRUE(prepared.shows(39, 39));
}

TEST(PreintegratedTransfer, WhatIsNotThereCountsAsZeroOrAsTheLowestPoint) {
  const TransferCurve from_10{{{10, 0, 1}, {20, 0.5f, 1}}};
  const TransferCurve from_minus_500{{{-500, 0, 1}, {100, 0.5f, 1}}};
  const TransferCurve all{{{10, 0.5f, 1}}};
  const TransferCurve falling{{{-100, 0.5f, 1}, {-50, 0, 1}}};

  const auto bytes = grey_scale(from_10, VoxelType::kUInt8);
  ASSERT_TRUE(bytes);
  EXPECT_TRUE(bytes->bytes);
  EXPECT_EQ(bytes->stored(77), 77);

  const auto shorts = grey_scale(from_10, VoxelType::kInt16);
  ASSERT_TRUE(shorts);
  EXPECT_FALSE(shorts->bytes);
  EXPECT_EQ(shorts->stored(0), 0);
  EXPECT_EQ(shorts->stored(20) - shorts->stored(10), 255);

  const auto hounsfield = grey_scale(from_minus_500, VoxelType::kInt16);  // 0 is visible
  ASSERT_TRUE(hounsfield);
  EXPECT_EQ(hounsfield->stored(-500), 0);
  EXPECT_EQ(hounsfield->stored(100), 255);

  EXPECT_EQ(grey_scale(falling, VoxelType::kInt16)->offset, 0);
  EXPECT_FALSE(grey_scale(all, VoxelType::kUInt8));
  EXPECT_FALSE(grey_scale(from_10, VoxelType::kNone));
}

/// Floats separate the sides of every ramp, however narrow or far from 0, at the right place.
TEST(PreintegratedTransfer, NarrowRampsFarAwayAreSteps) {
  for (const double low : {95.0, -95.0, 3e4, 1e9}) {
    const double high = std::nextafter(low, HUGE_VAL);
    const TransferCurve curve{{{low, low < 0 ? 0.5f : 0, 0}, {high, low < 0 ? 0 : 0.5f, 1}}};
    const auto scale = grey_scale(curve, VoxelType::kFloat64);
    ASSERT_TRUE(scale);
    const PreintegratedTransfer prepared(curve, *scale, kLength);
    ASSERT_EQ(infinities(prepared, PreintegratedTransfer::kMaxSegments - 1), 0u);
    const auto at = [&](double grey) { return static_cast<float>(scale->stored(grey)); };
    EXPECT_FALSE(low < 0 ? prepared.shows(at(low / 2), 0) : prepared.shows(0, at(low * 0.9999))) << low;
    EXPECT_TRUE(prepared.shows(at(low * 1.0001), at(low * 1.0001))) << low;
    EXPECT_LE(std::abs(at(low)), 1e5f);
  }
}

}  // namespace
}  // namespace splatlas
