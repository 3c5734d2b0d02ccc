#include "format/derive/smooth_gradient.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace splatlas {
namespace {

/// The definition: 7 x 7 x 7 taps, with the derivative along one axis.
std::array<double, 3> by_definition(const StructureCrop& crop, std::int64_t i, std::int64_t j,
                                    std::int64_t k) {
  double sum = 0, moment = 0;
  for (int t = -3; t <= 3; ++t) {
    sum += std::exp(-0.5 * t * t);
    moment += t * t * std::exp(-0.5 * t * t);
  }
  std::array<double, 3> gradient{0, 0, 0};
  for (std::int64_t dk = -3; dk <= 3; ++dk) {
    for (std::int64_t dj = -3; dj <= 3; ++dj) {
      for (std::int64_t di = -3; di <= 3; ++di) {
        const std::int64_t x = i + di, y = j + dj, z = k + dk;
        if (x < 0 || y < 0 || z < 0 || x >= crop.size[0] || y >= crop.size[1] || z >= crop.size[2]) continue;
        if (crop.parts[crop.offset(x, y, z)] == 0) continue;
        const double gauss = std::exp(-0.5 * static_cast<double>(di * di + dj * dj + dk * dk));
        const double scale = gauss / (sum * sum * moment);
        gradient[0] += scale * static_cast<double>(di);
        gradient[1] += scale * static_cast<double>(dj);
        gradient[2] += scale * static_cast<double>(dk);
      }
    }
  }
  return gradient;
}

RC_GTEST_PROP(SmoothGradient, IsTheConvolutionOfTheDefinition, ()) {
  StructureCrop crop;
  for (auto& n : crop.size) n = *rc::gen::inRange<std::int64_t>(1, 12);
  crop.parts = *rc::gen::container<std::vector<std::uint8_t>>(
      static_cast<std::size_t>(crop.size[0] * crop.size[1] * crop.size[2]),
      rc::gen::element<std::uint8_t>(0, 1));
  SmoothGradient gradient(crop);
  for (std::int64_t k = 0; k < crop.size[2]; ++k) {
    gradient.next_slice();
    for (std::int64_t j = 0; j < crop.size[1]; ++j) {
      for (std::int64_t i = 0; i < crop.size[0]; ++i) {
        const auto found = gradient.at(i, j);
        const auto expected = by_definition(crop, i, j, k);
        for (std::size_t a = 0; a < 3; ++a)
          RC_ASSERT(std::abs(static_cast<double>(found[a]) - expected[a]) < 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
