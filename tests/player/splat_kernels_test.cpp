#include "player/splat_kernels.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "player/span_model.h"

namespace splatlas {
namespace {

constexpr std::size_t kStride = 128;

/// Planes of floats, `kStride` apart.
using Planes = std::vector<float>;

Planes random_planes(std::mt19937& random, float low, float high) {
  std::uniform_real_distribution<float> value(low, high);
  Planes planes(4 * kStride);
  for (float& v : planes) v = value(random);
  return planes;
}

float largest(const Planes& planes) {
  float most = 0;
  for (const float v : planes) most = std::max(most, std::abs(v));
  return most;
}

class BothKernels : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] const SplatKernels& kernels() const { return GetParam() ? best_kernels() : scalar_kernels(); }
};
INSTANTIATE_TEST_SUITE_P(Kernels, BothKernels, testing::Bool(),
                         [](const auto& kernels) { return kernels.param ? "Best" : "Scalar"; });

/// What composite() does to one pixel, from its definition.
struct Composited {
  std::array<double, 3> color;
  double opacity;
};
Composited expected_pixel(const std::array<float, 4>& sheet, const std::array<float, 4>& image,
                          double slab_mm) {
  const double depth = static_cast<double>(sheet[0]) * slab_mm;
  const double through = 1 - static_cast<double>(image[3]);
  const double mean = depth > 0 ? -std::expm1(-depth) / depth : 1;
  Composited result{};
  for (std::size_t c = 0; c < 3; ++c) result.color[c] = image[c] + through * slab_mm * mean * sheet[c + 1];
  result.opacity = image[3] - through * std::expm1(-depth);
  return result;
}

TEST_P(BothKernels, SplatAddsTwoTapsAndNothingBeforeOrBehindTheirPadding) {
  std::mt19937 random(1);
  for (std::size_t length = 1; length <= 70; ++length) {
    // A span's planes: zeros before and behind it up to the padding.
    const std::size_t padded = (length + kSpanPadding) / kSpanPadding * kSpanPadding;
    std::vector<float> light(4 * (kSpanPadding + padded), 0);
    std::uniform_real_distribution<float> value(0, 2);
    for (std::size_t plane = 0; plane < 4; ++plane) {
      for (std::size_t n = 0; n < length; ++n)
        light[plane * (kSpanPadding + padded) + kSpanPadding + n] = value(random);
    }
    const std::size_t start = random() % 20;
    const Planes before = random_planes(random, -1, 1);
    Planes row = before;
    const float here = 0.7f;
    const float prior = 0.2f;
    kernels().splat(light.data() + kSpanPadding, kSpanPadding + padded, length + 1, here, prior,
                    row.data() + start, kStride);
    for (std::size_t plane = 0; plane < 4; ++plane) {
      const float* from = light.data() + plane * (kSpanPadding + padded) + kSpanPadding;
      for (std::size_t x = 0; x < kStride; ++x) {
        double expected = before[plane * kStride + x];
        if (x >= start && x <= start + length) {
          const std::size_t n = x - start;
          expected += static_cast<double>(here) * from[n] +
                      static_cast<double>(prior) * from[static_cast<std::ptrdiff_t>(n) - 1];
        }
        // Three roundings of values up to 3.
        ASSERT_NEAR(row[plane * kStride + x], expected, 6e-7) << "length " << length << ", pixel " << x;
      }
    }
  }
}

TEST_P(BothKernels, CompositeIsExactOverASlab) {
  std::mt19937 random(2);
  for (const float depth_scale : {1e-8f, 1e-6f, 1e-4f, 1e-2f, 1.0f, 10.0f, 100.0f, 1e4f}) {
    Planes row = random_planes(random, 0, depth_scale);
    Planes image = random_planes(random, 0, 1);
    const Planes sheet = row;
    const Planes front = image;
    const float slab_mm = 0.8f;
    kernels().composite(row.data(), kStride, kStride, slab_mm, image.data(), kStride);
    for (std::size_t x = 0; x < kStride; ++x) {
      const auto at = [x](const Planes& planes, std::size_t plane) { return planes[plane * kStride + x]; };
      const Composited expected =
          expected_pixel({at(sheet, 0), at(sheet, 1), at(sheet, 2), at(sheet, 3)},
                         {at(front, 0), at(front, 1), at(front, 2), at(front, 3)}, slab_mm);
      for (std::size_t c = 0; c < 3; ++c) {
        // One addition rounds to 6e-8 of the sum, the product to some 3e-7 of what is added.
        const double added = expected.color[c] - at(front, c);
        ASSERT_NEAR(at(image, c), expected.color[c], 6e-8 * expected.color[c] + 4e-7 * added + 1e-30)
            << kernels().name << ", depth " << at(sheet, 0) * slab_mm;
      }
      const double absorbed = expected.opacity - at(front, 3);
      ASSERT_NEAR(at(image, 3), expected.opacity, 6e-8 * expected.opacity + 4e-7 * absorbed + 1e-30);
      ASSERT_LE(at(image, 3), 1);
      for (std::size_t plane = 0; plane < 4; ++plane) ASSERT_EQ(at(row, plane), 0) << "row is cleared";
    }
  }
}

/// What is added to black: the opacity itself, without cancellation, to a few units in the last place.
TEST_P(BothKernels, OpacityOfThinSlabsDoesNotCancel) {
  for (double depth = 1e-12; depth < 200; depth *= 1.37) {
    Planes row(4 * kStride, 0);
    Planes image(4 * kStride, 0);
    for (std::size_t x = 0; x < kStride; ++x) {
      row[x] = row[kStride + x] = static_cast<float>(depth);
    }
    kernels().composite(row.data(), kStride, kStride, 1.0f, image.data(), kStride);
    const double expected = -std::expm1(-static_cast<double>(static_cast<float>(depth)));
    for (std::size_t x = 0; x < kStride; ++x) {
      ASSERT_NEAR(image[x] / expected, 1, 3e-7) << kernels().name << ", depth " << depth;
      ASSERT_NEAR(image[3 * kStride + x] / expected, 1, 3e-7) << kernels().name << ", depth " << depth;
    }
  }
}

TEST_P(BothKernels, EmptyPixelsStayAsTheyAreBitForBit) {
  std::mt19937 random(3);
  Planes row(4 * kStride, 0);
  Planes image = random_planes(random, 0, 1);
  const Planes before = image;
  kernels().composite(row.data(), kStride, kStride, 3.0f, image.data(), kStride);
  EXPECT_EQ(image, before);
}

TEST(SplatKernels, BestAgreesWithScalarOnAnyLength) {
  std::mt19937 random(4);
  for (std::size_t length = 1; length <= 70; ++length) {
    const Planes light = random_planes(random, 0, 1);
    const Planes row = random_planes(random, 0, 1);
    Planes best_row = row;
    Planes scalar_row = row;
    best_kernels().splat(light.data() + 1, kStride, length, 0.3f, 0.6f, best_row.data(), kStride);
    scalar_kernels().splat(light.data() + 1, kStride, length, 0.3f, 0.6f, scalar_row.data(), kStride);
    for (std::size_t plane = 0; plane < 4; ++plane) {
      for (std::size_t x = 0; x < length; ++x) {
        ASSERT_NEAR(best_row[plane * kStride + x], scalar_row[plane * kStride + x],
                    1e-6 * largest(scalar_row));
      }
    }
    const std::size_t pixels = (length + kSpanPadding - 1) / kSpanPadding * kSpanPadding;
    Planes best_image = random_planes(random, 0, 1);
    Planes scalar_image = best_image;
    scalar_row = best_row = row;
    best_kernels().composite(best_row.data(), kStride, pixels, 1.7f, best_image.data(), kStride);
    scalar_kernels().composite(scalar_row.data(), kStride, pixels, 1.7f, scalar_image.data(), kStride);
    for (std::size_t n = 0; n < best_image.size(); ++n) {
      ASSERT_NEAR(best_image[n], scalar_image[n], 1e-6 * largest(scalar_image));
    }
  }
}

}  // namespace
}  // namespace splatlas
