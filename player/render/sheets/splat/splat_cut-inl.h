// Choice of the splat kernel for rows that planes cut. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_SPLAT_CUT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_SPLAT_CUT_INL_H_
#undef SPLATLAS_PLAYER_SPLAT_CUT_INL_H_
#else
#define SPLATLAS_PLAYER_SPLAT_CUT_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/splat/splat-inl.h"
#include "player/render/sheets/splat/splat_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

template <int kEmissions, int kRows, int kPhases>
HWY_INLINE void CompositeCutPairs(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                                  float termination_threshold, const ImageRows& image) {
  Splat<kEmissions, kRows, kPhases, true> splat(rows, slab_mm, termination_threshold, image, &kept);
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair) splat.CompositePair(pair);
}

/// Every phase row by itself: at the borders of bands.
template <int kEmissions>
HWY_INLINE void CompositeCutOneByOne(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                                     float termination_threshold, const ImageRows& image) {
  SheetRows one = rows;
  one.rows_between = one.phase_count = 1;
  for (std::size_t row = 0; row < rows.rows_between; ++row) {
    for (std::size_t phase = 0; phase < rows.phase_count; ++phase) {
      one.lower_weights[0] = rows.lower_weights[row];
      one.phases[0] = rows.phases[phase];
      ImageRows phase_row = image;
      ClipRows kept_row = kept;
      const auto r = static_cast<std::int64_t>(row), p = static_cast<std::int64_t>(phase);
      phase_row.pixels += r * image.row_stride + p * image.phase_stride;
      if (phase_row.opaque != nullptr) phase_row.opaque += r * image.opaque_row_stride + p;
      kept_row.lines += r * kept.row_stride + p * kept.phase_stride;
      CompositeCutPairs<kEmissions, 1, 1>(one, kept_row, slab_mm, termination_threshold, phase_row);
    }
  }
}

template <int kEmissions>
HWY_INLINE void CompositeCutEmissions(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                                      float threshold, const ImageRows& image) {
  switch (10 * rows.rows_between + rows.phase_count) {
    case 11: return CompositeCutPairs<kEmissions, 1, 1>(rows, kept, slab_mm, threshold, image);
    case 22: return CompositeCutPairs<kEmissions, 2, 2>(rows, kept, slab_mm, threshold, image);
    case 33: return CompositeCutPairs<kEmissions, 3, 3>(rows, kept, slab_mm, threshold, image);
    default: return CompositeCutOneByOne<kEmissions>(rows, kept, slab_mm, threshold, image);
  }
}

inline void CompositeCutRows(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                             float termination_threshold, const ImageRows& image) {
  rows.slice->emissions == 1 ? CompositeCutEmissions<1>(rows, kept, slab_mm, termination_threshold, image)
                             : CompositeCutEmissions<3>(rows, kept, slab_mm, termination_threshold, image);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_SPLAT_CUT_INL_H_
