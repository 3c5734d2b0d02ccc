// Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/experiments/dense_kernel.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <array>
#include <cstdint>

#include <hwy/highway.h>

#include "bench/experiments/dense_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Bilinear weights of the voxels at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
using Weights = std::array<float, 4>;

/// One row of pixels, all planes. `upper` and `lower` are voxel rows, `out` a row of the sheet.
template <int kPlanes>
void CompositeRow(const float* upper, const float* lower, const Weights& weights, std::int64_t columns,
                  std::int64_t stride, float* HWY_RESTRICT out) {
  const hn::CappedTag<float, DenseVolume::kPad> d;
  const auto w00 = hn::Set(d, weights[0]), w10 = hn::Set(d, weights[1]);
  const auto w01 = hn::Set(d, weights[2]), w11 = hn::Set(d, weights[3]);
  for (std::int64_t x = 0; x < columns; x += static_cast<std::int64_t>(hn::Lanes(d))) {
    float* const alphas = out + (kPlanes - 1) * stride + x;
    const auto alpha = hn::LoadU(d, alphas);
    const auto transmittance = hn::Sub(hn::Set(d, 1.0f), alpha);
    for (int plane = 0; plane < kPlanes; ++plane) {
      const std::int64_t at = plane * stride + x;
      auto value = hn::Mul(w00, hn::LoadU(d, upper + at));
      value = hn::MulAdd(w10, hn::LoadU(d, upper + at + 1), value);
      value = hn::MulAdd(w01, hn::LoadU(d, lower + at), value);
      value = hn::MulAdd(w11, hn::LoadU(d, lower + at + 1), value);
      const auto before = plane == kPlanes - 1 ? alpha : hn::LoadU(d, out + at);
      hn::StoreU(hn::MulAdd(transmittance, value, before), d, out + at);
    }
  }
}

template <int kPlanes>
void CompositeBand(const DenseVolume& volume, std::int64_t first, std::int64_t last, DenseSheet& sheet) {
  const std::int64_t stride = volume.stride();
  const int phases = sheet.scale * sheet.scale;
  for (std::int64_t slice = 0; slice < volume.slices; ++slice) {
    const auto shift = static_cast<float>(slice % 7) / (7 * static_cast<float>(sheet.scale));
    for (std::int64_t y = first; y < last; ++y) {
      for (int phase = 0; phase < phases; ++phase) {
        const int column = phase % sheet.scale, row = phase / sheet.scale;
        const float u = shift + static_cast<float>(column) / static_cast<float>(sheet.scale);
        const float v = shift + static_cast<float>(row) / static_cast<float>(sheet.scale);
        const Weights weights{(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
        CompositeRow<kPlanes>(volume.row(slice, y), volume.row(slice, y + 1), weights, volume.columns, stride,
                              sheet.pixels.data() + (y * phases + phase) * kPlanes * stride);
      }
    }
  }
}

void Composite(const DenseVolume& volume, std::int64_t first, std::int64_t last, DenseSheet& sheet) {
  volume.planes == 2 ? CompositeBand<2>(volume, first, last, sheet)
                     : CompositeBand<4>(volume, first, last, sheet);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

namespace splatlas {
namespace {

HWY_EXPORT(Composite);

constexpr std::int64_t kBandBytes = std::int64_t{1}
                                    << 17;  // band of the sheet: well within the second-level cache

}  // namespace

DenseVolume DenseVolume::fog(std::int64_t columns, std::int64_t rows, std::int64_t slices, int planes) {
  DenseVolume volume{columns, rows, slices, planes, {}};
  volume.values.resize(static_cast<std::size_t>(slices * (rows + 1) * planes * volume.stride() + kPad));
  std::uint32_t random = 1;
  for (float& value : volume.values) {
    random = random * 1664525 + 1013904223;
    value = 0.01f * static_cast<float>(random >> 8) / static_cast<float>(1 << 24);
  }
  return volume;
}

void composite_dense(const DenseVolume& volume, DenseSheet& sheet) {
  const std::int64_t row_floats = std::int64_t{sheet.scale} * sheet.scale * volume.planes * volume.stride();
  sheet.pixels.assign(static_cast<std::size_t>(volume.rows * row_floats), 0.0f);
  const std::int64_t band =
      std::max<std::int64_t>(1, kBandBytes / (row_floats * std::int64_t{sizeof(float)}));
  for (std::int64_t first = 0; first < volume.rows; first += band) {
    HWY_DYNAMIC_DISPATCH(Composite)(volume, first, std::min(first + band, volume.rows), sheet);
  }
}

}  // namespace splatlas
#endif  // HWY_ONCE
