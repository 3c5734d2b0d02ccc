// Splatting and compositing kernels of a slice (hot loop).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "player/render/clip/clip_slabs.h"
#include "player/render/sheets/spans/span_model.h"

namespace splatlas {

/// The pixels of a sheet row with one common sub-pixel offset to the voxels of a slice, one per voxel. For a
/// voxel row m, pixel x is (1 - before) * m[x - shift] + before * m[x - shift - 1].
struct Phase {
  float before = 0;  ///< [0, 1)
  std::int64_t shift = 0;
};

/// Rows of sheet pixels and the slice to splat. In sheared object space all voxels of a slice have the same
/// sub-pixel offset (Lacroute and Levoy 1994). The weights of the footprint, a tent of one voxel to each
/// side, are therefore constant. A row of pixels between two voxel rows splats the interpolated voxel row (1
/// - lower_weight) * upper[i] + lower_weight * lower[i].
struct SheetRows {
  static constexpr std::size_t kMaxRows = 3, kMaxPhases = 3;
  /// Maximum number of rows, or phases, per kernel call for a sheet of `scale` pixels per voxel.
  [[nodiscard]] static constexpr std::size_t group_size(int scale) { return scale % 3 == 0 ? 3 : 2; }

  const SliceSpans* slice = nullptr;
  std::int64_t upper = 0;  ///< the first upper voxel row, an argument of slice->row()
  std::int64_t pairs = 0;  ///< pairs of voxel rows: (upper, upper + 1), (upper + 1, upper + 2), ...
  std::array<float, kMaxRows> lower_weights{};  ///< [0, 1), of the rows of pixels between a pair
  std::size_t rows_between = 1;                 ///< 1 to kMaxRows
  std::array<Phase, kMaxPhases> phases;         ///< their shifts differ by at most one
  std::size_t phase_count = 1;                  ///< 1 to kMaxPhases
};

/// Pixels [first, last) of a phase row with a transmittance of at most the termination threshold.
struct OpaquePixels {
  std::int64_t first = 0, last = 0;
};

/// Accumulated radiance along the rays. Each phase of each row has one plane per emission of the spans
/// (premultiplied, linear), followed by the opacity.
struct ImageRows {
  /// Accessible pixels before and after each plane. A block may begin at the last pixel of a plane in one
  /// phase, and one pixel further in another.
  static constexpr std::int64_t kMargin = kBlock + 1;

  float* pixels = nullptr;  ///< pixel 0 of the first phase of the first row
  std::int64_t columns = 0;
  /// In floats; `pair_stride` is that between the first rows of consecutive pairs.
  std::int64_t plane_stride = 0, phase_stride = 0, row_stride = 0, pair_stride = 0;
  /// Known opaque pixels of each phase row, empty before the first slice and extended by kernels.
  /// Requires the same termination threshold for all slices. May be null.
  OpaquePixels* opaque = nullptr;
  std::int64_t opaque_row_stride = 0, opaque_pair_stride = 0;  ///< phases are adjacent
};

/// Optical properties with a weight; null counts as zero.
struct WeightedOptics {
  const float* optics = nullptr;  ///< aligned to cache lines
  float weight = 0;
};

/// Kernels for one instruction set. Thread-safe for disjoint images.
struct SplatKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Splats rows (Westover 1990) and composites them behind the accumulated radiance. With constant
  /// extinction k and emission e along a slab of length d = `slab_mm`, the exact update is
  ///   colour += (1 - opacity) * e * (1 - exp(-k d)) / k,   opacity += (1 - opacity) * (1 - exp(-k d)).
  /// Early ray termination: pixels with a transmittance of at most `termination_threshold` may remain
  /// unchanged. `clip` multiplies the length of the slab by the kept fraction at each pixel. Cost: linear in
  /// the blocks of the spans that reach visible pixels. Opaque blocks cost a test of their pixels, or nothing
  /// if they are known in `image.opaque`.
  void (*composite)(const SheetRows& rows, const ClipRows& clip, float slab_mm, float termination_threshold,
                    const ImageRows& image);

  /// Weighted sum of `floats` values, a multiple of kBlock. At least one input is not null; `mixed` is
  /// aligned to cache lines, too.
  void (*mix)(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed);
};

/// Scalar reference kernels. SPLATLAS_SIMD=scalar in the environment forces them.
[[nodiscard]] SplatKernels scalar_kernels();
/// The fastest kernels for this CPU (Highway, dispatched at run time). Every instruction set and the scalar
/// reference compute the same operations, rounded alike: results agree to 1e-6 of the largest value with any
/// termination threshold, and are the same bits on machines with fused multiply-add. Combinations of rows and
/// phases that sheets do not need are composited row by row and phase by phase.
[[nodiscard]] SplatKernels best_kernels();

}  // namespace splatlas
