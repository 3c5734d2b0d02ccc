// Kept fractions of cut slabs at blocks of pixels. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#undef SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#else
#define SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/splat/block_runs.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Blocks of a pair of rows: to composite, with the block before, which supplies the carry; and kept whole.
struct ClipBlocks {
  Blocks visible, whole;

  HWY_INLINE ClipBlocks(const ClipPixels& pixels, const SheetRows& rows) {
    if (pixels.first_visible >= pixels.last_visible) return;
    std::int64_t min_shift = rows.phases[0].shift, max_shift = min_shift;
    for (std::size_t phase = 1; phase < rows.phase_count; ++phase) {
      min_shift = std::min(min_shift, rows.phases[phase].shift);
      max_shift = std::max(max_shift, rows.phases[phase].shift);
    }
    visible = {((pixels.first_visible - max_shift) >> kBlockBits) - 1,
               (pixels.last_visible - min_shift + kBlock - 1) >> kBlockBits};
    whole = {(pixels.first_whole - min_shift + kBlock - 1) >> kBlockBits,
             (pixels.last_whole - max_shift) >> kBlockBits};
  }
};

/// Kept fractions at the pixels from `first` on, given the lines of their phase row.
template <class D>
HWY_INLINE WideVec<D> KeptFractions(D d, const ClipRows& kept, const ClipLine* line, std::int64_t first) {
  alignas(64) static constexpr float kNumbers[kBlock] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                         8, 9, 10, 11, 12, 13, 14, 15};
  const auto zero = Zero(d), one = Set(d, 1.0f);
  const auto numbers = Load(d, kNumbers);
  auto entering = one, leaving = one;
  for (int n = 0; n < kept.planes; ++n, ++line) {
    const auto steps = Add(numbers, Set(d, static_cast<float>(first - line->whole)));
    const auto fraction = FusedMulAdd(d, Set(d, line->per_pixel), steps, Set(d, line->at_whole));
    if (n < kept.entering) {
      entering = Min(entering, fraction);
    } else {
      leaving = Min(leaving, fraction);
    }
  }
  return Max(Sub(Add(Max(entering, zero), Max(leaving, zero)), one), zero);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
