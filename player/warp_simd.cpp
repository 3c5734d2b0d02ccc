// The warp once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/warp_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <array>
#include <cstdint>

#include <hwy/highway.h>

#include "player/sheets.h"
#include "player/warp_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBatch = 16;  // places found together
constexpr int kFractionBits = 24;

/// Places as the offset of their upper left neighbour, in floats, and the shares of the differences to the
/// others: right, below, and both at once.
struct Places {
  HWY_ALIGN std::int32_t offset[kBatch];
  HWY_ALIGN float right[kBatch];
  HWY_ALIGN float below[kBatch];
  HWY_ALIGN float both[kBatch];
};

HWY_INLINE void FindPlaces(const WarpWalk& walk, std::int64_t x, std::int64_t y, Places& places) {
  const hn::CappedTag<std::int32_t, kBatch> di;
  const hn::RebindToFloat<decltype(di)> df;
  const auto fraction = hn::Set(di, (1 << kFractionBits) - 1);
  const auto unit = hn::Set(df, 1.0f / (1 << kFractionBits));
  const auto start = [](std::int64_t at) {
    return static_cast<std::int32_t>((at & 0xffffffff) >> (32 - kFractionBits));
  };
  const auto step = [](std::int64_t by) {
    return static_cast<std::int32_t>((by + (1 << (31 - kFractionBits))) >> (32 - kFractionBits));
  };
  const auto x0 = hn::Set(di, start(x)), y0 = hn::Set(di, start(y));
  const auto dx = hn::Set(di, step(walk.step_x)), dy = hn::Set(di, step(walk.step_y));
  const auto row_floats = hn::Set(di, static_cast<std::int32_t>(walk.stride * walk.channels));
  const auto pixel_floats = hn::Set(di, walk.channels);
  for (std::size_t n = 0; n < kBatch; n += hn::Lanes(di)) {
    const auto lane = hn::Iota(di, static_cast<std::int32_t>(n));
    const auto px = hn::Add(x0, hn::Mul(dx, lane));
    const auto py = hn::Add(y0, hn::Mul(dy, lane));
    const auto column = hn::ShiftRight<kFractionBits>(px);
    const auto row = hn::ShiftRight<kFractionBits>(py);
    hn::Store(hn::Add(hn::Mul(row, row_floats), hn::Mul(column, pixel_floats)), di, places.offset + n);
    const auto right = hn::Mul(hn::ConvertTo(df, hn::And(px, fraction)), unit);
    const auto below = hn::Mul(hn::ConvertTo(df, hn::And(py, fraction)), unit);
    hn::Store(right, df, places.right + n);
    hn::Store(below, df, places.below + n);
    // As far as no weight falls below 0.
    const auto both = hn::Mul(right, below);
    const auto other_both = hn::Sub(hn::Sub(hn::Set(df, 1.0f), right), hn::Sub(below, both));
    const auto most = hn::Min(hn::Sub(right, both), hn::Sub(below, both));
    const auto least = hn::Neg(hn::Min(both, other_both));
    const auto skew = hn::Min(hn::Max(hn::Set(df, walk.skew), least), most);
    hn::Store(hn::Add(both, skew), df, places.both + n);
  }
}

/// One sample of 4 channels: `upper` and the pixel after it, and the two one row below.
HWY_INLINE void Sample4(const float* upper, const float* lower, float right, float below, float both,
                        float* out) {
#if HWY_TARGET <= HWY_AVX2  // two pixels in a vector
  const hn::FixedTag<float, 4> d;
  const hn::FixedTag<float, 8> dd;
  const auto above = hn::LoadU(dd, upper);
  const auto down = hn::Sub(hn::LoadU(dd, lower), above);
  const auto left = hn::LowerHalf(d, above), left_down = hn::LowerHalf(d, down);
  auto light = hn::MulAdd(hn::Set(d, below), left_down, left);
  light = hn::MulAdd(hn::Set(d, right), hn::Sub(hn::UpperHalf(d, above), left), light);
  light = hn::MulAdd(hn::Set(d, both), hn::Sub(hn::UpperHalf(d, down), left_down), light);
  hn::StoreU(light, d, out);
#else
  const hn::CappedTag<float, 4> d;
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    const auto left = hn::LoadU(d, upper + c), beside = hn::LoadU(d, upper + 4 + c);
    const auto left_down = hn::Sub(hn::LoadU(d, lower + c), left);
    const auto beside_down = hn::Sub(hn::LoadU(d, lower + 4 + c), beside);
    auto light = hn::MulAdd(hn::Set(d, below), left_down, left);
    light = hn::MulAdd(hn::Set(d, right), hn::Sub(beside, left), light);
    light = hn::MulAdd(hn::Set(d, both), hn::Sub(beside_down, left_down), light);
    hn::StoreU(light, d, out + c);
  }
#endif
}

/// One sample of white and opacity; `color` ends with 1.
HWY_INLINE void Sample2(const float* upper, const float* lower, float right, float below, float both,
                        const float* HWY_RESTRICT color, float* out) {
#if HWY_TARGET != HWY_SCALAR  // two pixels in a vector
  const hn::FixedTag<float, 4> d;
  const auto above = hn::LoadU(d, upper);
  const auto down = hn::Sub(hn::LoadU(d, lower), above);
  // Left pixel in the lower half: left + below * left_down; right one: right * beside + both * beside_down.
  auto light = hn::MulAdd(hn::Set(d, below), down, above);
  light = hn::MulAdd(hn::Set(d, right), hn::Sub(hn::Shuffle1032(above), above), light);
  light = hn::MulAdd(hn::Set(d, both), hn::Sub(hn::Shuffle1032(down), down), light);
  const auto white = hn::Broadcast<0>(light);
  const auto opacity = hn::Broadcast<1>(light);
  const auto last = hn::Eq(hn::Iota(d, 0), hn::Set(d, 3));
  hn::StoreU(hn::Mul(hn::IfThenElse(last, opacity, white), hn::LoadU(d, color)), d, out);
#else
  float light[2];
  for (std::size_t c = 0; c < 2; ++c) {
    const float left_down = lower[c] - upper[c], beside_down = lower[2 + c] - upper[2 + c];
    light[c] =
        upper[c] + below * left_down + right * (upper[2 + c] - upper[c]) + both * (beside_down - left_down);
  }
  for (std::size_t c = 0; c < 4; ++c) out[c] = color[c] * light[c == 3 ? 1 : 0];
#endif
}

template <int kChannels>
HWY_INLINE void WarpChannels(const WarpWalk& walk, std::size_t count, float* out) {
  Places places;
  HWY_ALIGN const float color[4] = {walk.color[0], walk.color[1], walk.color[2], 1};
  std::int64_t x = walk.x, y = walk.y;
  for (std::size_t done = 0; done < count; done += kBatch) {
    FindPlaces(walk, x, y, places);
    const float* origin = walk.pixels + ((y >> 32) * walk.stride + (x >> 32)) * kChannels;
    const std::size_t batch = std::min(kBatch, count - done);
    for (std::size_t n = 0; n < batch; ++n) {
      const float* upper = origin + places.offset[n];
      const float* lower = upper + walk.stride * kChannels;
      float* pixel = out + 4 * (done + n);
      if constexpr (kChannels == 4) {
        Sample4(upper, lower, places.right[n], places.below[n], places.both[n], pixel);
      } else {
        Sample2(upper, lower, places.right[n], places.below[n], places.both[n], color, pixel);
      }
    }
    x += static_cast<std::int64_t>(kBatch) * walk.step_x;
    y += static_cast<std::int64_t>(kBatch) * walk.step_y;
  }
}

void Warp(const WarpWalk& walk, std::size_t count, float* out) {
  walk.channels == 2 ? WarpChannels<2>(walk, count, out) : WarpChannels<4>(walk, count, out);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(Warp);

void warp(const WarpWalk& walk, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(Warp)(walk, count, out);
}

void plain_warp(const WarpWalk& walk, std::size_t count, float* out) {
  constexpr float kUnit = 1.0f / 4294967296.0f;
  const std::int64_t channels = walk.channels;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int64_t x = walk.x + static_cast<std::int64_t>(n) * walk.step_x;
    const std::int64_t y = walk.y + static_cast<std::int64_t>(n) * walk.step_y;
    const float right = static_cast<float>(x & 0xffffffff) * kUnit;
    const float below = static_cast<float>(y & 0xffffffff) * kUnit;
    const float* upper = walk.pixels + ((y >> 32) * walk.stride + (x >> 32)) * channels;
    const float* lower = upper + walk.stride * channels;
    const std::array<float, 4> weights = sheet_weights(right, below, walk.skew);
    std::array<float, 4> light{};
    for (std::int64_t c = 0; c < channels; ++c) {
      light[static_cast<std::size_t>(c)] = weights[0] * upper[c] + weights[1] * upper[channels + c] +
                                           weights[2] * lower[c] + weights[3] * lower[channels + c];
    }
    if (channels == 2)
      light = {light[0] * walk.color[0], light[0] * walk.color[1], light[0] * walk.color[2], light[1]};
    std::copy(light.begin(), light.end(), out + 4 * n);
  }
}

}  // namespace

const WarpKernels& scalar_warp() {
  static constexpr WarpKernels kKernels{"scalar", plain_warp, plain_cubic};
  return kKernels;
}

const WarpKernels& best_warp() {
  static const WarpKernels kKernels =
      scalar_is_forced() ? scalar_warp() : WarpKernels{best_target(), warp, best_cubic};
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE
