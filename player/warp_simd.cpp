// The warp once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/warp_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <cstdint>

#include <hwy/highway.h>

#include "player/warp_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBatch = 16;  // places found together
constexpr int kFractionBits = 24;

/// Places as the offset of their upper left neighbour and the weights of the right and lower ones.
struct Places {
  HWY_ALIGN std::int32_t offset[kBatch];
  HWY_ALIGN float right[kBatch];
  HWY_ALIGN float below[kBatch];
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
  const auto stride = hn::Set(di, static_cast<std::int32_t>(walk.stride));
  for (std::size_t n = 0; n < kBatch; n += hn::Lanes(di)) {
    const auto lane = hn::Iota(di, static_cast<std::int32_t>(n));
    const auto px = hn::Add(x0, hn::Mul(dx, lane));
    const auto py = hn::Add(y0, hn::Mul(dy, lane));
    const auto column = hn::ShiftRight<kFractionBits>(px);
    const auto row = hn::ShiftRight<kFractionBits>(py);
    hn::Store(hn::Add(hn::Mul(row, stride), column), di, places.offset + n);
    hn::Store(hn::Mul(hn::ConvertTo(df, hn::And(px, fraction)), unit), df, places.right + n);
    hn::Store(hn::Mul(hn::ConvertTo(df, hn::And(py, fraction)), unit), df, places.below + n);
  }
}

/// One sample: `upper` and the pixel after it, and the two one row below.
HWY_INLINE void Sample(const float* upper, const float* lower, float right, float below, float* out) {
#if HWY_TARGET <= HWY_AVX2  // two pixels in a vector
  const hn::FixedTag<float, 4> d;
  const hn::FixedTag<float, 8> dd;
  const auto above = hn::LoadU(dd, upper);
  const auto pair = hn::MulAdd(hn::Set(dd, below), hn::Sub(hn::LoadU(dd, lower), above), above);
  const auto left = hn::LowerHalf(d, pair);
  hn::StoreU(hn::MulAdd(hn::Set(d, right), hn::Sub(hn::UpperHalf(d, pair), left), left), d, out);
#else
  const hn::CappedTag<float, 4> d;
  const auto weight = hn::Set(d, below);
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    const auto above_left = hn::LoadU(d, upper + c);
    const auto above_right = hn::LoadU(d, upper + 4 + c);
    const auto left = hn::MulAdd(weight, hn::Sub(hn::LoadU(d, lower + c), above_left), above_left);
    const auto beside = hn::MulAdd(weight, hn::Sub(hn::LoadU(d, lower + 4 + c), above_right), above_right);
    hn::StoreU(hn::MulAdd(hn::Set(d, right), hn::Sub(beside, left), left), d, out + c);
  }
#endif
}

void Warp(const WarpWalk& walk, std::size_t count, float* out) {
  Places places;
  std::int64_t x = walk.x, y = walk.y;
  for (std::size_t done = 0; done < count; done += kBatch) {
    FindPlaces(walk, x, y, places);
    const Light* origin = walk.pixels + (y >> 32) * walk.stride + (x >> 32);
    const std::size_t batch = std::min(kBatch, count - done);
    for (std::size_t n = 0; n < batch; ++n) {
      const Light* upper = origin + places.offset[n];
      Sample(upper->rgba.data(), (upper + walk.stride)->rgba.data(), places.right[n], places.below[n],
             out + 4 * (done + n));
    }
    x += static_cast<std::int64_t>(kBatch) * walk.step_x;
    y += static_cast<std::int64_t>(kBatch) * walk.step_y;
  }
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
  for (std::size_t n = 0; n < count; ++n) {
    const std::int64_t x = walk.x + static_cast<std::int64_t>(n) * walk.step_x;
    const std::int64_t y = walk.y + static_cast<std::int64_t>(n) * walk.step_y;
    const float right = static_cast<float>(x & 0xffffffff) * kUnit;
    const float below = static_cast<float>(y & 0xffffffff) * kUnit;
    const Light* upper = walk.pixels + (y >> 32) * walk.stride + (x >> 32);
    const Light* lower = upper + walk.stride;
    for (std::size_t c = 0; c < 4; ++c) {
      const float left = upper[0].rgba[c] + below * (lower[0].rgba[c] - upper[0].rgba[c]);
      const float beside = upper[1].rgba[c] + below * (lower[1].rgba[c] - upper[1].rgba[c]);
      out[4 * n + c] = left + right * (beside - left);
    }
  }
}

}  // namespace

const WarpKernels& scalar_warp() {
  static constexpr WarpKernels kKernels{"scalar", plain_warp};
  return kKernels;
}

const WarpKernels& best_warp() {
  static const WarpKernels kKernels = scalar_is_forced() ? scalar_warp() : WarpKernels{best_target(), warp};
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE
