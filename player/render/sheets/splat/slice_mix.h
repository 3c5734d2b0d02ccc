// Linear interpolation of optical properties between two slices.
#pragma once

#include <cstdint>
#include <span>

#include "player/render/sheets/spans/span_model.h"
#include "player/render/sheets/splat/block_runs.h"
#include "player/render/sheets/splat/splat_kernels.h"

namespace splatlas {

/// Two neighbouring slices and a position between them. Either is null at the ends of the volume.
struct SlicePair {
  const SliceSpans* before = nullptr;
  const SliceSpans* behind = nullptr;
  float behind_weight = 0;  ///< 0 at the slice before, 1 at the slice behind
};

/// Interpolates rows [first, last) of the grid; of each, only the blocks that `visible` names, unless it is
/// empty. `mixed` is overwritten and keeps its capacity. Its spans are
/// the union of both slices' spans, without voxel counts and shaded voxels. Linear in the blocks.
void mix_slices(const SlicePair& pair, std::int64_t first, std::int64_t last, std::span<const Blocks> visible,
                const SplatKernels& kernels, SliceSpans& mixed);

}  // namespace splatlas
