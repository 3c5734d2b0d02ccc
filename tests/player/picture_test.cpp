#include "player/picture.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "tests/reference/reference_radiance.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// The sRGB code of a linear value before rounding.
double exact_code(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  return 255 * (clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1 / 2.4) - 0.055);
}

/// Rounding to the nearest code, plus up to 0.1 codes where the steps of the table are widest.
constexpr double kRounding = 0.5 + 0.1;

Picture picture_of(const std::vector<std::array<float, 4>>& pixels) {
  Picture picture{{static_cast<int>(pixels.size()), 1}, {}};
  for (const auto& pixel : pixels) picture.rgba.insert(picture.rgba.end(), pixel.begin(), pixel.end());
  return picture;
}

TEST(Picture, EverySrgbCodeComesBack) {
  std::vector<std::array<float, 4>> pixels;
  for (int code = 0; code < 256; ++code) {
    const float linear = srgb_to_linear(static_cast<std::uint8_t>(code));
    pixels.push_back({linear, linear, linear, 1});
  }
  const std::vector<std::uint8_t> opaque = to_srgb8(picture_of(pixels), {9, 9, 9});
  const std::vector<std::uint8_t> with_alpha = to_srgba8(picture_of(pixels));
  for (std::size_t code = 0; code < 256; ++code) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(opaque[3 * code + c], code);
      EXPECT_EQ(with_alpha[4 * code + c], code);
    }
    EXPECT_EQ(with_alpha[4 * code + 3], 255);
  }
}

TEST(Picture, CompositesOverTheBackgroundInLinearLight) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<std::array<float, 4>> pixels;
  for (int n = 0; n < 2000; ++n) {
    const float alpha = unit(random);
    pixels.push_back({alpha * unit(random), alpha * unit(random), alpha * unit(random), alpha});
  }
  pixels.push_back({0, 0, 0, 0});
  const Rgb background{10, 120, 250};
  const auto behind = reference::linear_of(background);
  const std::vector<std::uint8_t> bytes = to_srgb8(picture_of(pixels), background);
  ASSERT_EQ(bytes.size(), 3 * pixels.size());
  for (std::size_t n = 0; n < pixels.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(bytes[3 * n + c],
                  exact_code(pixels[n][c] + (1 - static_cast<double>(pixels[n][3])) * behind[c]), kRounding);
    }
  }
  EXPECT_EQ(bytes[bytes.size() - 3], 10);
  EXPECT_EQ(bytes[bytes.size() - 2], 120);
  EXPECT_EQ(bytes[bytes.size() - 1], 250);
}

TEST(Picture, FilesWithAlphaHoldStraightColors) {
  const std::vector<std::uint8_t> bytes = to_srgba8(
      picture_of({{0.1f, 0.2f, 0.4f, 0.4f}, {0, 0, 0, 0}, {1e-9f, 0, 0, 1e-9f}, {0.5f, 0, 0, 0.25f}}));
  EXPECT_NEAR(bytes[0], exact_code(0.25), kRounding);
  EXPECT_NEAR(bytes[1], exact_code(0.5), kRounding);
  EXPECT_EQ(bytes[2], 255);
  EXPECT_EQ(bytes[3], 102);
  for (std::size_t n = 4; n < 8; ++n) EXPECT_EQ(bytes[n], 0);  // empty is black and transparent
  EXPECT_EQ(bytes[8], 255);                                    // the colour survives minimal opacity
  EXPECT_EQ(bytes[11], 0);
  EXPECT_EQ(bytes[12], 255);  // colour above opacity is clamped, not wrapped
}

TEST(Picture, OpacitiesWithoutAFiniteReciprocalKeepTheirColors) {
  const float min = std::numeric_limits<float>::denorm_min();
  const std::vector<std::uint8_t> bytes =
      to_srgba8(picture_of({{0, 1e-39f, 5e-40f, 1e-39f}, {0, min, 0, min}}));
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[1], 255);
  EXPECT_NEAR(bytes[2], exact_code(0.5), kRounding);
  EXPECT_EQ(bytes[3], 0);
  EXPECT_EQ(bytes[4], 0);
  EXPECT_EQ(bytes[5], 255);
  EXPECT_EQ(bytes[7], 0);
}

TEST(Picture, NotANumberIsBlackAndTransparent) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Picture picture = picture_of({{none, infinity, -infinity, none}, {none, infinity, -infinity, 1}});
  EXPECT_THAT(to_srgba8(picture), testing::ElementsAre(0, 0, 0, 0, 0, 255, 0, 255));
  const std::vector<std::uint8_t> opaque = to_srgb8(picture, {9, 9, 9});
  EXPECT_THAT(std::vector(opaque.begin() + 3, opaque.end()), testing::ElementsAre(0, 255, 0));
}

}  // namespace
}  // namespace splatlas
