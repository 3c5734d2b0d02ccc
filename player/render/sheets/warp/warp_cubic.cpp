// Bicubic warp kernel. Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/sheets/warp/warp_cubic.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <array>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/warp/warp_kernels.h"

#ifndef SPLATLAS_PLAYER_WARP_CUBIC_CPP_
#define SPLATLAS_PLAYER_WARP_CUBIC_CPP_
namespace splatlas {

constexpr int kTaps = 4;  // along each axis

/// Position of a sample: the first of its 4 x 4 pixels, and the fraction from the second to the third.
struct CubicPlace {
  std::int64_t left = 0, upper = 0;
  float right = 0, below = 0;

  CubicPlace(const CubicWalk& walk, std::size_t n) {
    const double x = walk.x + static_cast<double>(n) * walk.step_x;
    const double y = walk.y + static_cast<double>(n) * walk.step_y;
    const std::int64_t column = floor_of(x), row = floor_of(y);
    left = column - 1;
    upper = row - 1;
    right = static_cast<float>(x - static_cast<double>(column));
    below = static_cast<float>(y - static_cast<double>(row));
  }
  [[nodiscard]] bool inside(const CubicWalk& walk) const {
    return left >= 0 && upper >= 0 && left + kTaps <= walk.columns && upper + kTaps <= walk.rows;
  }

 private:
  /// std::floor() is a function call for baseline x86-64.
  static std::int64_t floor_of(double value) {
    const auto whole = static_cast<std::int64_t>(value);
    return whole - (value < static_cast<double>(whole) ? 1 : 0);
  }
};

/// Catmull-Rom weights (1974) of the two pixels before and the two after a position.
inline std::array<float, kTaps> cubic_weights(float part) {
  const float rest = 1 - part;
  return {-0.5f * part * rest * rest, 1 + part * part * (1.5f * part - 2.5f),
          1 + rest * rest * (1.5f * rest - 2.5f), -0.5f * rest * part * part};
}

/// One sample at any position; pixels outside the sheet are zero.
inline void sample_plainly(const CubicWalk& walk, const CubicPlace& place, float* out) {
  const std::array<float, kTaps> across = cubic_weights(place.right), down = cubic_weights(place.below);
  const auto channels = static_cast<std::size_t>(walk.channels);
  std::array<float, 4> rgba{};
  for (std::int64_t v = 0; v < kTaps; ++v) {
    const std::int64_t row = place.upper + v;
    if (row < 0 || row >= walk.rows) continue;
    for (std::int64_t u = 0; u < kTaps; ++u) {
      const std::int64_t column = place.left + u;
      if (column < 0 || column >= walk.columns) continue;
      const float* const pixel = walk.pixels + (row * walk.stride + column) * walk.channels;
      const float weight = down[static_cast<std::size_t>(v)] * across[static_cast<std::size_t>(u)];
      for (std::size_t c = 0; c < channels; ++c) rgba[c] += weight * pixel[c];
    }
  }
  if (channels == 2)
    rgba = {rgba[0] * walk.color[0], rgba[0] * walk.color[1], rgba[0] * walk.color[2], rgba[1]};
  const float alpha = std::clamp(rgba[3], 0.0f, 1.0f);
  for (std::size_t c = 0; c < 4; ++c) out[c] = std::clamp(rgba[c], 0.0f, alpha);
}

}  // namespace splatlas
#endif  // SPLATLAS_PLAYER_WARP_CUBIC_CPP_

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
using Four = hn::FixedTag<float, 4>;
using FourFloats = hn::Vec<Four>;

/// Polynomials in `part` by Horner's scheme: cubic_weights(), repeated for each channel of a pixel.
HWY_INLINE FourFloats CubicWeights(const float (&powers)[4][4], float part) {
  const Four d;
  const auto t = hn::Set(d, part);
  auto weights = hn::MulAdd(hn::LoadU(d, powers[3]), t, hn::LoadU(d, powers[2]));
  weights = hn::MulAdd(weights, t, hn::LoadU(d, powers[1]));
  return hn::MulAdd(weights, t, hn::LoadU(d, powers[0]));
}

/// Weighted sum of 4 x 4 pixels: red, green, blue, opacity.
HWY_INLINE FourFloats Sum4(const float* pixels, std::int64_t row_floats, const CubicPlace& place) {
  const Four d;
  const std::array<float, kTaps> across = cubic_weights(place.right), down = cubic_weights(place.below);
  auto sum = hn::Zero(d);
  for (std::size_t v = 0; v < kTaps; ++v, pixels += row_floats) {
    auto row = hn::Mul(hn::Set(d, across[0]), hn::LoadU(d, pixels));
    for (std::size_t u = 1; u < kTaps; ++u)
      row = hn::MulAdd(hn::Set(d, across[u]), hn::LoadU(d, pixels + 4 * u), row);
    sum = hn::MulAdd(hn::Set(d, down[v]), row, sum);
  }
  return sum;
}

/// The same for pixels of white and opacity; `color` ends with 1.
HWY_INLINE FourFloats Sum2(const float* pixels, std::int64_t row_floats, const CubicPlace& place,
                           FourFloats color) {
  // Coefficients by power, for two pixels of two channels: the first two and the last two pixels.
  static constexpr float kFirst[4][4] = {
      {0, 0, 1, 1}, {-0.5f, -0.5f, 0, 0}, {1, 1, -2.5f, -2.5f}, {-0.5f, -0.5f, 1.5f, 1.5f}};
  static constexpr float kLast[4][4] = {
      {0, 0, 0, 0}, {0.5f, 0.5f, 0, 0}, {2, 2, -0.5f, -0.5f}, {-1.5f, -1.5f, 0.5f, 0.5f}};
  const Four d;
  const std::array<float, kTaps> down = cubic_weights(place.below);
  auto first = hn::Zero(d), last = hn::Zero(d);
  for (std::size_t v = 0; v < kTaps; ++v, pixels += row_floats) {
    const auto weight = hn::Set(d, down[v]);
    first = hn::MulAdd(weight, hn::LoadU(d, pixels), first);
    last = hn::MulAdd(weight, hn::LoadU(d, pixels + 4), last);
  }
  auto sum = hn::Mul(first, CubicWeights(kFirst, place.right));
  sum = hn::MulAdd(last, CubicWeights(kLast, place.right), sum);
  sum = hn::Add(sum, hn::Shuffle1032(sum));
  const auto is_opacity = hn::Eq(hn::Iota(d, 0), hn::Set(d, 3));
  return hn::Mul(hn::IfThenElse(is_opacity, hn::Broadcast<1>(sum), hn::Broadcast<0>(sum)), color);
}

template <int kChannels>
HWY_INLINE void WarpChannels(const CubicWalk& walk, std::size_t count, float* out) {
  const Four d;
  const float color_and_one[4] = {walk.color[0], walk.color[1], walk.color[2], 1};
  const auto color = hn::LoadU(d, color_and_one);
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t n = 0; n < count; ++n) {
    const CubicPlace place(walk, n);
    if (HWY_UNLIKELY(!place.inside(walk))) {
      sample_plainly(walk, place, out + 4 * n);
      continue;
    }
    const float* const pixels = walk.pixels + (place.upper * walk.stride + place.left) * kChannels;
    FourFloats rgba;
    if constexpr (kChannels == 2) {
      rgba = Sum2(pixels, walk.stride * kChannels, place, color);
    } else {
      rgba = Sum4(pixels, walk.stride * kChannels, place);
    }
    const auto alpha = hn::Min(hn::Max(hn::Broadcast<3>(rgba), zero), one);
    hn::StoreU(hn::Min(hn::Max(rgba, zero), alpha), d, out + 4 * n);
  }
}

void WarpCubic(const CubicWalk& walk, std::size_t count, float* out) {
  walk.channels == 2 ? WarpChannels<2>(walk, count, out) : WarpChannels<4>(walk, count, out);
}
#else
void WarpCubic(const CubicWalk& walk, std::size_t count, float* out) {
  plain_cubic(walk, count, out);
}
#endif

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace splatlas {

HWY_EXPORT(WarpCubic);

void best_cubic(const CubicWalk& walk, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(WarpCubic)(walk, count, out);
}

void plain_cubic(const CubicWalk& walk, std::size_t count, float* out) {
  for (std::size_t n = 0; n < count; ++n) sample_plainly(walk, CubicPlace(walk, n), out + 4 * n);
}

}  // namespace splatlas
#endif  // HWY_ONCE
