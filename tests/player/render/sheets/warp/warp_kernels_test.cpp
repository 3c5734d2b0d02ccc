#include "player/render/sheets/warp/warp_kernels.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/reference/cubic.h"
#include "tests/support/every_kernel.h"

namespace splatlas {
namespace {

constexpr std::int64_t kSide = 40;

std::vector<float> random_sheet(std::mt19937& random, int channels) {
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<float> pixels(kSide * kSide * static_cast<std::size_t>(channels));
  for (float& f : pixels) f = value(random);
  return pixels;
}

std::int64_t fixed(double value) {
  return std::llround(value * 4294967296.0);
}

/// The definition, in double precision.
double expected_at(const WarpWalk& walk, double x, double y, std::size_t c) {
  const auto column = static_cast<std::int64_t>(std::floor(x));
  const auto row = static_cast<std::int64_t>(std::floor(y));
  const double right = x - static_cast<double>(column);
  const double below = y - static_cast<double>(row);
  const double max = std::min(right * (1 - below), below * (1 - right));
  const double min = -std::min(right * below, (1 - right) * (1 - below));
  const double skew = std::clamp(static_cast<double>(walk.skew), min, max);
  const std::int64_t channel = walk.channels == 4 ? static_cast<std::int64_t>(c) : c == 3 ? 1 : 0;
  const auto at = [&](std::int64_t dx, std::int64_t dy) {
    return static_cast<double>(
        walk.pixels[((row + dy) * walk.stride + column + dx) * walk.channels + channel]);
  };
  const double value = ((1 - below) * (1 - right) + skew) * at(0, 0) +
                       ((1 - below) * right - skew) * at(1, 0) + (below * (1 - right) - skew) * at(0, 1) +
                       (below * right + skew) * at(1, 1);
  return walk.channels == 2 && c < 3 ? value * static_cast<double>(walk.color[c]) : value;
}

class WarpKernelsOf : public EveryKernel {
 protected:
  [[nodiscard]] static WarpKernels kernels() { return is_reference() ? scalar_warp() : best_warp(); }
};
INSTANTIATE_TEST_SUITE_P(Every, WarpKernelsOf, testing::ValuesIn(targets_and_reference()), kernel_name);

TEST_P(WarpKernelsOf, WeighsFourNeighboursAndWritesNoMoreThanAsked) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, kSide - 1.001);
  for (const int channels : {2, 4}) {
    const std::vector<float> pixels = random_sheet(random, channels);
    for (int n = 0; n < 400; ++n) {
      // Between two random places of the sheet.
      const double x0 = place(random), y0 = place(random), x1 = place(random), y1 = place(random);
      const double length = std::hypot(x1 - x0, y1 - y0);
      const auto count = static_cast<std::size_t>(length / 1.2) + 2 + random() % 70;
      const double step_x = (x1 - x0) / static_cast<double>(count),
                   step_y = (y1 - y0) / static_cast<double>(count);
      WarpWalk walk;
      walk.pixels = pixels.data();
      walk.stride = kSide;
      walk.channels = channels;
      walk.color = {0.25f, 0.5f, 0.75f};
      walk.skew = static_cast<float>(n % 5 - 2) * 0.0625f;
      walk.x = fixed(x0);
      walk.y = fixed(y0);
      walk.step_x = fixed(step_x);
      walk.step_y = fixed(step_y);
      std::vector<float> out(4 * (count + 4), -7.0f);
      kernels().warp(walk, count, out.data());
      for (std::size_t pixel = 0; pixel < count; ++pixel) {
        const double x = x0 + static_cast<double>(pixel) * step_x;
        const double y = y0 + static_cast<double>(pixel) * step_y;
        for (std::size_t c = 0; c < 4; ++c)
          ASSERT_NEAR(out[4 * pixel + c], expected_at(walk, x, y, c), 3e-6) << "pixel " << pixel;
      }
      for (std::size_t f = 4 * count; f < out.size(); ++f) ASSERT_EQ(out[f], -7.0f);
    }
  }
}

/// Inside the sheet, across its border and beside it.
TEST_P(WarpKernelsOf, CubicsWeighSixteenNeighboursAndStayInBounds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-4, kSide + 4), step(-0.7, 0.7);
  std::size_t cut = 0;
  for (const int channels : {2, 4}) {
    std::vector<float> pixels = random_sheet(random, channels);
    for (std::size_t n = 0; n < pixels.size(); ++n) {  // colours are at most alpha
      const std::size_t opacity =
          n / static_cast<std::size_t>(channels) * static_cast<std::size_t>(channels) +
          static_cast<std::size_t>(channels) - 1;
      if (n != opacity) pixels[n] *= pixels[opacity];
    }
    for (int n = 0; n < 300; ++n) {
      const CubicWalk walk{pixels.data(),    kSide - 3,     kSide,         kSide,        channels,
                           {0.25f, 0.5f, 1}, place(random), place(random), step(random), step(random)};
      const std::size_t count = 1 + random() % 50;
      std::vector<float> out(4 * (count + 2), -7.0f);
      kernels().cubic(walk, count, out.data());
      for (std::size_t pixel = 0; pixel < count; ++pixel) {
        const double x = walk.x + static_cast<double>(pixel) * walk.step_x;
        const double y = walk.y + static_cast<double>(pixel) * walk.step_y;
        std::array<double, 4> expected{};
        for (std::int64_t row = 0; row < walk.rows; ++row) {
          for (std::int64_t column = 0; column < walk.columns; ++column) {
            const double weight = reference::catmull_rom(x - static_cast<double>(column)) *
                                  reference::catmull_rom(y - static_cast<double>(row));
            if (weight == 0) continue;
            const float* const from =
                &pixels[static_cast<std::size_t>((row * walk.stride + column) * channels)];
            for (std::size_t c = 0; c < 4; ++c) {
              const double channel = channels == 4 ? from[c] : c == 3 ? from[1] : from[0] * walk.color[c];
              expected[c] += weight * channel;
            }
          }
        }
        const double alpha = std::clamp(expected[3], 0.0, 1.0);
        if (alpha != expected[3]) ++cut;
        for (std::size_t c = 0; c < 4; ++c)
          ASSERT_NEAR(out[4 * pixel + c], std::clamp(expected[c], 0.0, alpha), 2e-6) << x << ", " << y;
      }
      for (std::size_t c = 4 * count; c < out.size(); ++c) ASSERT_EQ(out[c], -7.0f);
    }
  }
  EXPECT_GT(cut, 100u);
}

}  // namespace
}  // namespace splatlas
