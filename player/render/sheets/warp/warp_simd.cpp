// SIMD warp kernel. Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/sheets/warp/warp_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/sheets/warp/warp_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBatch = 16;  // positions per batch
constexpr int kFractionBits = 24;

/// Sample positions of a batch. `offset` is that of the upper left neighbour, in floats; the others are the
/// weights of the differences to the right, to below, and of the mixed difference.
struct WarpPlaces {
  HWY_ALIGN std::int32_t offset[kBatch];
  HWY_ALIGN float right[kBatch];
  HWY_ALIGN float below[kBatch];
  HWY_ALIGN float both[kBatch];
};

HWY_INLINE void FindPlaces(const WarpWalk& walk, std::int64_t x, std::int64_t y, WarpPlaces& places) {
  // Convert start and step to fixed point of kFractionBits
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

  // Split positions into pixels and fractions
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

    // Clamp the skew so that no weight is negative
    const auto both = hn::Mul(right, below);
    const auto other_both = hn::Sub(hn::Sub(hn::Set(df, 1.0f), right), hn::Sub(below, both));
    const auto max_skew = hn::Min(hn::Sub(right, both), hn::Sub(below, both));
    const auto min_skew = hn::Neg(hn::Min(both, other_both));
    const auto skew = hn::Min(hn::Max(hn::Set(df, walk.skew), min_skew), max_skew);
    hn::Store(hn::Add(both, skew), df, places.both + n);
  }
}

/// One sample of 4 channels from the pixel at `upper`, its right neighbour, and the two pixels at `lower`.
HWY_INLINE void Sample4(const float* upper, const float* lower, float right, float below, float both,
                        float* out) {
#if HWY_TARGET <= HWY_AVX2  // two pixels in a vector
  const hn::FixedTag<float, 4> d;
  const hn::FixedTag<float, 8> dd;
  const auto above = hn::LoadU(dd, upper);
  const auto down = hn::Sub(hn::LoadU(dd, lower), above);
  const auto left = hn::LowerHalf(d, above), left_down = hn::LowerHalf(d, down);
  auto rgba = hn::MulAdd(hn::Set(d, below), left_down, left);
  rgba = hn::MulAdd(hn::Set(d, right), hn::Sub(hn::UpperHalf(d, above), left), rgba);
  rgba = hn::MulAdd(hn::Set(d, both), hn::Sub(hn::UpperHalf(d, down), left_down), rgba);
  hn::StoreU(rgba, d, out);
#else
  const hn::CappedTag<float, 4> d;
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    const auto left = hn::LoadU(d, upper + c), beside = hn::LoadU(d, upper + 4 + c);
    const auto left_down = hn::Sub(hn::LoadU(d, lower + c), left);
    const auto beside_down = hn::Sub(hn::LoadU(d, lower + 4 + c), beside);
    auto rgba = hn::MulAdd(hn::Set(d, below), left_down, left);
    rgba = hn::MulAdd(hn::Set(d, right), hn::Sub(beside, left), rgba);
    rgba = hn::MulAdd(hn::Set(d, both), hn::Sub(beside_down, left_down), rgba);
    hn::StoreU(rgba, d, out + c);
  }
#endif
}

#if HWY_TARGET != HWY_SCALAR
/// Pixels of 4 floats per vector.
#if HWY_TARGET <= HWY_AVX3
constexpr std::size_t kPixels = 4;
#elif HWY_TARGET <= HWY_AVX2
constexpr std::size_t kPixels = 2;
#else
constexpr std::size_t kPixels = 1;
#endif
using Pixels = hn::FixedTag<float, 4 * kPixels>;

/// Gathers 4 floats from each of `kCount` offsets.
template <std::size_t kCount>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4 * kCount>> LoadFours(const float* origin,
                                                              const std::int32_t* offsets) {
  const hn::FixedTag<float, 4 * kCount> d;
  if constexpr (kCount == 1) {
    return hn::LoadU(d, origin + offsets[0]);
  } else {
    return hn::Combine(d, LoadFours<kCount / 2>(origin, offsets + kCount / 2),
                       LoadFours<kCount / 2>(origin, offsets));
  }
}

/// Repeats each of `kCount` numbers four times.
template <std::size_t kCount>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4 * kCount>> FourTimes(const float* numbers) {
  const hn::FixedTag<float, 4 * kCount> d;
  if constexpr (kCount == 1) {
    return hn::Set(d, numbers[0]);
  } else if constexpr (kCount == 4) {
    const auto pixel = hn::ShiftRight<2>(hn::Iota(hn::RebindToSigned<decltype(d)>(), 0));
    return hn::TableLookupLanes(hn::LoadDup128(d, numbers), hn::IndicesFromVec(d, pixel));
  } else {
    return hn::Combine(d, FourTimes<kCount / 2>(numbers + kCount / 2), FourTimes<kCount / 2>(numbers));
  }
}

/// Samples of white and opacity at kPixels positions; `color` is red, green, blue and 1.
HWY_INLINE void SampleWhite(const float* upper, const float* lower, const WarpPlaces& places, std::size_t n,
                            const float* HWY_RESTRICT color, float* out) {
  const Pixels d;
  const hn::RebindToSigned<Pixels> di;
  const auto above = LoadFours<kPixels>(upper, places.offset + n);
  const auto down = hn::Sub(LoadFours<kPixels>(lower, places.offset + n), above);
  // Each group of 4 lanes has the left pixel in its lower half, the right one in its upper half.
  auto rgba = hn::MulAdd(FourTimes<kPixels>(places.below + n), down, above);
  rgba = hn::MulAdd(FourTimes<kPixels>(places.right + n), hn::Sub(hn::Shuffle1032(above), above), rgba);
  rgba = hn::MulAdd(FourTimes<kPixels>(places.both + n), hn::Sub(hn::Shuffle1032(down), down), rgba);
  const auto three = hn::Set(di, 3);
  const auto last = hn::RebindMask(d, hn::Eq(hn::And(hn::Iota(di, 0), three), three));
  const auto shown = hn::IfThenElse(last, hn::Broadcast<1>(rgba), hn::Broadcast<0>(rgba));
  hn::StoreU(hn::Mul(shown, hn::LoadDup128(d, color)), d, out);
}
#else
constexpr std::size_t kPixels = 1;

HWY_INLINE void SampleWhite(const float* upper, const float* lower, const WarpPlaces& places, std::size_t n,
                            const float* HWY_RESTRICT color, float* out) {
  upper += places.offset[n];
  lower += places.offset[n];
  float rgba[2];
  for (std::size_t c = 0; c < 2; ++c) {
    const float left_down = lower[c] - upper[c], beside_down = lower[2 + c] - upper[2 + c];
    rgba[c] = upper[c] + places.below[n] * left_down + places.right[n] * (upper[2 + c] - upper[c]) +
              places.both[n] * (beside_down - left_down);
  }
  for (std::size_t c = 0; c < 4; ++c) out[c] = color[c] * rgba[c == 3 ? 1 : 0];
}
#endif

/// Calls sample(origin, places, n, out) for groups of kAtOnce positions, the first of which is n.
template <std::size_t kAtOnce, typename Sample>
HWY_INLINE void ForEachPlace(const WarpWalk& walk, std::size_t count, float* out, const Sample& sample) {
  static_assert(kBatch % kAtOnce == 0);
  WarpPlaces places;
  std::int64_t x = walk.x, y = walk.y;
  for (std::size_t done = 0; done < count; done += kBatch) {
    FindPlaces(walk, x, y, places);
    const float* origin = walk.pixels + ((y >> 32) * walk.stride + (x >> 32)) * walk.channels;
    const std::size_t batch = std::min(kBatch, count - done);
    std::size_t n = 0;
    for (; n + kAtOnce <= batch; n += kAtOnce) sample(origin, places, n, out + 4 * (done + n));
    if (n < batch) {
      // Pad the last group
      for (std::size_t last = batch; last < n + kAtOnce; ++last) places.offset[last] = places.offset[n];
      HWY_ALIGN float rest[4 * kAtOnce];
      sample(origin, places, n, rest);
      std::copy_n(rest, 4 * (batch - n), out + 4 * (done + n));
    }
    x += static_cast<std::int64_t>(kBatch) * walk.step_x;
    y += static_cast<std::int64_t>(kBatch) * walk.step_y;
  }
}

HWY_INLINE void WarpColors(const WarpWalk& walk, std::size_t count, float* out) {
  const std::int64_t row = walk.stride * 4;
  ForEachPlace<1>(walk, count, out,
                  [row](const float* origin, const WarpPlaces& places, std::size_t n, float* pixel) {
                    const float* upper = origin + places.offset[n];
                    Sample4(upper, upper + row, places.right[n], places.below[n], places.both[n], pixel);
                  });
}

HWY_INLINE void WarpWhite(const WarpWalk& walk, std::size_t count, float* out) {
  const std::int64_t row = walk.stride * 2;
  HWY_ALIGN const float color[4] = {walk.color[0], walk.color[1], walk.color[2], 1};
  ForEachPlace<kPixels>(walk, count, out,
                        [&](const float* origin, const WarpPlaces& places, std::size_t n, float* pixels) {
                          SampleWhite(origin, origin + row, places, n, color, pixels);
                        });
}

void Warp(const WarpWalk& walk, std::size_t count, float* out) {
  walk.channels == 2 ? WarpWhite(walk, count, out) : WarpColors(walk, count, out);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/render/simd/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(Warp);

void plain_warp(const WarpWalk& walk, std::size_t count, float* out) {
  constexpr float kUnit = 1.0f / 4294967296.0f;
  const std::int64_t channels = walk.channels;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int64_t x = walk.x + static_cast<std::int64_t>(n) * walk.step_x;
    const std::int64_t y = walk.y + static_cast<std::int64_t>(n) * walk.step_y;
    const float right = static_cast<float>(x & 0xffffffff) * kUnit;
    const float below = static_cast<float>(y & 0xffffffff) * kUnit;
    const float* upper = walk.pixels + ((y >> 32) * walk.stride + (x >> 32)) * channels;
    const Radiance radiance = sheet_sample(upper, walk.stride * channels, channels,
                                           sheet_weights(right, below, walk.skew), walk.color);
    std::copy(radiance.rgba.begin(), radiance.rgba.end(), out + 4 * n);
  }
}

}  // namespace

WarpKernels scalar_warp() {
  return {"scalar", plain_warp, plain_cubic};
}

WarpKernels best_warp() {
  if (scalar_is_forced()) return scalar_warp();
  return {best_target(), HWY_DYNAMIC_DISPATCH(Warp), best_cubic};
}

}  // namespace splatlas
#endif  // HWY_ONCE
