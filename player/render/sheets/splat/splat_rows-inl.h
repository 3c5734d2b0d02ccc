// Choice of the splat kernel for the rows and phases of a call. Compiled once for every instruction set.
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

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

template <int kEmissions, int kRows, int kPhases>
HWY_INLINE void CompositePairs(const SheetRows& rows, float slab_mm, float termination_threshold,
                               const ImageRows& image) {
  Splat<kEmissions, kRows, kPhases> splat(rows, slab_mm, termination_threshold, image);
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair) splat.CompositePair(pair);
}

/// Every phase row by itself.
template <int kEmissions>
HWY_INLINE void CompositeOneByOne(const SheetRows& rows, float slab_mm, float termination_threshold,
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
      CompositePairs<kEmissions, 1, 1>(one, slab_mm, termination_threshold, phase_row);
    }
  }
}

template <int kEmissions>
HWY_INLINE void CompositeEmissions(const SheetRows& rows, float slab_mm, float termination_threshold,
                                   const ImageRows& image) {
  switch (10 * rows.rows_between + rows.phase_count) {
    case 11: return CompositePairs<kEmissions, 1, 1>(rows, slab_mm, termination_threshold, image);
    case 12: return CompositePairs<kEmissions, 1, 2>(rows, slab_mm, termination_threshold, image);
    case 13: return CompositePairs<kEmissions, 1, 3>(rows, slab_mm, termination_threshold, image);
    case 21: return CompositePairs<kEmissions, 2, 1>(rows, slab_mm, termination_threshold, image);
    case 22: return CompositePairs<kEmissions, 2, 2>(rows, slab_mm, termination_threshold, image);
    case 33: return CompositePairs<kEmissions, 3, 3>(rows, slab_mm, termination_threshold, image);
    default: return CompositeOneByOne<kEmissions>(rows, slab_mm, termination_threshold, image);
  }
}

inline void CompositeRows(const SheetRows& rows, float slab_mm, float termination_threshold,
                          const ImageRows& image) {
  rows.slice->emissions == 1 ? CompositeEmissions<1>(rows, slab_mm, termination_threshold, image)
                             : CompositeEmissions<3>(rows, slab_mm, termination_threshold, image);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_SPLAT_ROWS_INL_H_
