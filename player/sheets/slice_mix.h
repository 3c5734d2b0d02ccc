// The light between two slices.
#pragma once

#include <cstdint>

#include "player/sheets/splat_kernels.h"
#include "player/spans/span_model.h"

namespace splatlas {

/// Two neighbouring slices and a place between them; either may be null, where the volume ends.
struct SlicePair {
  const SliceSpans* before = nullptr;
  const SliceSpans* behind = nullptr;
  float behind_weight = 0;  ///< linear: 0 at the slice before, 1 at the one behind
};

/// Interpolates rows [first, last) of the grid. `mixed` is overwritten, its memory used again; its spans are
/// the union of both slices', their voxels are not counted and none is listed as shaded. Cost: the blocks of
/// those rows.
void mix_slices(const SlicePair& pair, std::int64_t first, std::int64_t last, const SplatKernels& kernels,
                SliceSpans& mixed);

}  // namespace splatlas
