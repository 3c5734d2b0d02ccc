// HOT LOOP: splatting a row of voxels into a sheet and compositing it, chosen once per frame for the machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "player/span_model.h"

namespace splatlas {

/// One row of sheet pixels at one slice. In the sheared grid every voxel of a slice has the same sub-pixel
/// offset, so the footprint (a tent, one voxel to each side) has constant weights: with the mixed row
///   m[i] = near_weight * near[i] + far_weight * far[i]
/// of the two rows of voxels whose footprints reach the row, pixel x is here * m[x - shift] + before *
/// m[x - shift - 1].
struct SheetRow {
  const float* light = nullptr;  ///< of the slice
  std::span<const Span> near, far;
  float near_weight = 0, far_weight = 0;
  float here = 0, before = 0;
  std::int64_t shift = 0;
};

/// What has been accumulated along the rays of one row of sheet pixels so far.
struct ImageRow {
  /// Pixels that may be read and written before the first one and behind the last one.
  static constexpr std::int64_t kMargin = kBlock;

  float* planes = nullptr;  ///< red, green, blue (premultiplied, linear), opacity; `stride` apart
  std::size_t stride = 0;
  std::int64_t columns = 0;
};

struct SplatKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Splats a row and composites it behind what is accumulated. Along a slab of `slab_mm` extinction k and
  /// emission e are constant, so exactly
  ///   colour += (1 - opacity) * e * (1 - exp(-k d)) / k,   opacity += (1 - opacity) * (1 - exp(-k d)).
  /// Nothing is added to blocks that let through no more than `floor` everywhere. Cost: the blocks of the
  /// spans, opaque ones next to nothing.
  void (*composite)(const SheetRow& row, float slab_mm, float floor, const ImageRow& image);
};

/// Plain C++, the twin that others are compared with.
[[nodiscard]] const SplatKernels& scalar_kernels();
/// The best that this machine runs (Highway, dispatched at run time). Agrees with the scalar twin to about
/// 1e-6 of the largest value. SPLATLAS_SIMD=scalar in the environment forces the twin.
[[nodiscard]] const SplatKernels& best_kernels();

}  // namespace splatlas
