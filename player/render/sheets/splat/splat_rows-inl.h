// Choice of the splat kernel for a call; weighted sums of slices. Compiled for every instruction set.
#if defined(SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_
#undef SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_
#else
#define SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/splat/splat-inl.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

template <int kEmissions, int kRows, int kPhases, class Clip>
void CompositePairs(const SheetRows& rows, const Clip& clip, float slab_mm, float threshold,
                    const ImageRows& image) {
  Splat<kEmissions, kRows, kPhases, Clip> splat(rows, clip, slab_mm, threshold, image);
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair) splat.CompositePair(pair);
}

/// Every phase row by itself.
template <int kEmissions, class Clip>
void CompositeOneByOne(const SheetRows& rows, const Clip& clip, float slab_mm, float threshold,
                       const ImageRows& image) {
  SheetRows one = rows;
  one.rows_between = one.phase_count = 1;
  for (std::size_t row = 0; row < rows.rows_between; ++row) {
    for (std::size_t phase = 0; phase < rows.phase_count; ++phase) {
      one.lower_weights[0] = rows.lower_weights[row];
      one.phases[0] = rows.phases[phase];
      ImageRows phase_row = image;
      const auto r = static_cast<std::int64_t>(row), p = static_cast<std::int64_t>(phase);
      phase_row.pixels += r * image.row_stride + p * image.phase_stride;
      if (phase_row.opaque != nullptr) phase_row.opaque += r * image.opaque_row_stride + p;
      CompositePairs<kEmissions, 1, 1>(one, clip.PhaseRow(r, p), slab_mm, threshold, phase_row);
    }
  }
}

template <int kEmissions, class Clip>
void CompositeEmissions(const SheetRows& rows, const Clip& clip, float slab_mm, float threshold,
                        const ImageRows& image) {
  const std::size_t group = 10 * rows.rows_between + rows.phase_count;
  if constexpr (Clip::kHasAllGroups) {
    if (group == 12) return CompositePairs<kEmissions, 1, 2>(rows, clip, slab_mm, threshold, image);
    if (group == 13) return CompositePairs<kEmissions, 1, 3>(rows, clip, slab_mm, threshold, image);
    if (group == 21) return CompositePairs<kEmissions, 2, 1>(rows, clip, slab_mm, threshold, image);
  }
  switch (group) {
    case 11: return CompositePairs<kEmissions, 1, 1>(rows, clip, slab_mm, threshold, image);
    case 22: return CompositePairs<kEmissions, 2, 2>(rows, clip, slab_mm, threshold, image);
    case 33: return CompositePairs<kEmissions, 3, 3>(rows, clip, slab_mm, threshold, image);
    default: return CompositeOneByOne<kEmissions>(rows, clip, slab_mm, threshold, image);
  }
}

template <class Clip>
void CompositeClipped(const SheetRows& rows, const Clip& clip, float slab_mm, float threshold,
                      const ImageRows& image) {
  rows.slice->emissions == 1 ? CompositeEmissions<1>(rows, clip, slab_mm, threshold, image)
                             : CompositeEmissions<3>(rows, clip, slab_mm, threshold, image);
}

inline void CompositeRows(const SheetRows& rows, const ClipRows& clip, float slab_mm, float threshold,
                          const ImageRows& image) {
  clip.planes == 0 ? CompositeClipped(rows, NoPixelClip(), slab_mm, threshold, image)
                   : CompositeClipped(rows, PixelClip(clip), slab_mm, threshold, image);
}

/// The weighted sum of optical properties.
inline void MixOptics(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  using Tag = NativeTag<WideTag<float, kBlock>>;
  const Tag d;
  const auto weight_a = Set(d, a.weight), weight_b = Set(d, b.weight);
  if (a.optics == nullptr || b.optics == nullptr) {
    const float* const optics = a.optics != nullptr ? a.optics : b.optics;
    const auto weight = a.optics != nullptr ? weight_a : weight_b;
    for (std::size_t n = 0; n < floats; n += kLanesOf<Tag>)
      Store(Mul(weight, Load(d, optics + n)), d, mixed + n);
    return;
  }
  for (std::size_t n = 0; n < floats; n += kLanesOf<Tag>) {
    const auto of_a = Mul(weight_a, Load(d, a.optics + n));
    Store(FusedMulAdd(d, weight_b, Load(d, b.optics + n), of_a), d, mixed + n);
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_
