#include "player/warp_kernels.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

constexpr std::int64_t kSide = 40;

std::vector<Light> random_sheet(std::mt19937& random) {
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<Light> pixels(kSide * kSide);
  for (Light& light : pixels) light = {{value(random), value(random), value(random), value(random)}};
  return pixels;
}

std::int64_t fixed(double value) {
  return std::llround(value * 4294967296.0);
}

/// Bilinear, in double precision.
double expected_at(const std::vector<Light>& pixels, double x, double y, std::size_t c) {
  const auto column = static_cast<std::int64_t>(std::floor(x));
  const auto row = static_cast<std::int64_t>(std::floor(y));
  const double right = x - static_cast<double>(column);
  const double below = y - static_cast<double>(row);
  const auto at = [&](std::int64_t dx, std::int64_t dy) {
    return static_cast<double>(pixels[static_cast<std::size_t>((row + dy) * kSide + column + dx)].rgba[c]);
  };
  return (1 - below) * ((1 - right) * at(0, 0) + right * at(1, 0)) +
         below * ((1 - right) * at(0, 1) + right * at(1, 1));
}

class BothWarps : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] const WarpKernels& kernels() const { return GetParam() ? best_warp() : scalar_warp(); }
};
INSTANTIATE_TEST_SUITE_P(Kernels, BothWarps, testing::Bool(),
                         [](const auto& kernels) { return kernels.param ? "Best" : "Scalar"; });

TEST_P(BothWarps, SamplesBilinearlyAndWritesNoMoreThanAsked) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, kSide - 1.001);
  const std::vector<Light> pixels = random_sheet(random);
  for (int n = 0; n < 400; ++n) {
    // From one place in the sheet to another.
    const double x0 = place(random), y0 = place(random), x1 = place(random), y1 = place(random);
    const double length = std::hypot(x1 - x0, y1 - y0);
    const auto count = static_cast<std::size_t>(length / 1.2) + 2 + random() % 70;
    const double step_x = (x1 - x0) / static_cast<double>(count),
                 step_y = (y1 - y0) / static_cast<double>(count);
    std::vector<float> out(4 * (count + 4), -7.0f);
    kernels().warp({pixels.data(), kSide, fixed(x0), fixed(y0), fixed(step_x), fixed(step_y)}, count,
                   out.data());
    for (std::size_t pixel = 0; pixel < count; ++pixel) {
      const double x = x0 + static_cast<double>(pixel) * step_x;
      const double y = y0 + static_cast<double>(pixel) * step_y;
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_NEAR(out[4 * pixel + c], expected_at(pixels, x, y, c), 3e-6) << kernels().name << ' ' << pixel;
    }
    for (std::size_t f = 4 * count; f < out.size(); ++f) ASSERT_EQ(out[f], -7.0f);
  }
}

}  // namespace
}  // namespace splatlas
