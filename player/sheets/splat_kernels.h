// HOT LOOP: splatting the rows of a slice into a sheet and compositing it, chosen once per frame for the
// machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/spans/span_model.h"

namespace splatlas {

/// Pixels of a row of the sheet that have one sub-pixel offset to the voxels of a slice: one per voxel. With
/// the row of voxels m, pixel x is (1 - before) * m[x - shift] + before * m[x - shift - 1].
struct Phase {
  float before = 0;  ///< [0, 1)
  std::int64_t shift = 0;
};

/// Rows of sheet pixels at one slice. In the sheared grid every voxel of a slice has the same sub-pixel
/// offset, so the footprint (a tent, one voxel to each side) has constant weights. Between two rows of voxels
/// lie one or more rows of pixels, whose voxels are the mix (1 - lower_weight) * upper[i] + lower_weight *
/// lower[i].
struct SheetRows {
  /// Three rows have one phase or three.
  static constexpr std::size_t kMaxRows = 3, kMaxPhases = 3;
  /// Rows, or phases, that are splatted together where a sheet has `scale` of them.
  [[nodiscard]] static constexpr std::size_t together(int scale) { return scale % 3 == 0 ? 3 : 2; }

  const SliceSpans* slice = nullptr;
  std::int64_t upper = 0;  ///< the first upper row of voxels, counted as slice->row() does
  std::int64_t pairs = 0;  ///< of rows of voxels: (upper, upper + 1), (upper + 1, upper + 2), ...
  std::array<float, kMaxRows> lower_weights{};  ///< [0, 1), of the rows of pixels between a pair
  std::size_t rows_between = 1;
  std::array<Phase, kMaxPhases> phases;  ///< their shifts differ by one at most
  std::size_t phase_count = 1;
};

/// Pixels [first, last) of a row and phase that are known to let through no more than the floor.
struct OpaquePixels {
  std::int64_t first = 0, last = 0;
};

/// What has been accumulated along the rays so far. Each phase of each row has as many planes as the spans
/// have emissions (premultiplied, linear), and then the opacity.
struct ImageRows {
  /// Pixels of a plane that may be read and written before the first one and behind the last one: a block
  /// whose first pixel is the last of the plane in one phase, and behind it in the other.
  static constexpr std::int64_t kMargin = kBlock + 1;

  float* pixels = nullptr;  ///< pixel 0 of the first phase of the first row
  std::int64_t columns = 0;
  /// In floats; the last one between the first rows of consecutive pairs.
  std::int64_t plane_stride = 0, phase_stride = 0, row_stride = 0, pair_stride = 0;
  /// One per row and phase, empty before the first slice: kernels add to them what they find. All slices have
  /// the same floor then. May be null.
  OpaquePixels* opaque = nullptr;
  std::int64_t opaque_row_stride = 0, opaque_pair_stride = 0;  ///< those of phases follow each other
};

/// Light with a weight; null is dark.
struct WeightedOptics {
  const float* light = nullptr;  ///< aligned to cache lines
  float weight = 0;
};

struct SplatKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Splats rows and composites them behind what is accumulated. Along a slab of `slab_mm` extinction k and
  /// emission e are constant, so exactly
  ///   colour += (1 - opacity) * e * (1 - exp(-k d)) / k,   opacity += (1 - opacity) * (1 - exp(-k d)).
  /// Pixels that let through no more than `floor` may be left as they are. Cost: the blocks of the spans;
  /// those whose pixels are all opaque next to nothing, and nothing where `image.opaque` knows it.
  void (*composite)(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image);

  /// The sum of two, at least one of which is not null: `floats` of them, a multiple of kBlock, to `mixed`,
  /// aligned as they are.
  void (*mix)(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed);
};

/// Plain C++, the twin that others are compared with.
[[nodiscard]] const SplatKernels& scalar_kernels();
/// The best that this machine runs (Highway, dispatched at run time). Agrees with the scalar twin to about
/// 1e-6 of the largest value with a floor of 0, and to the floor otherwise. SPLATLAS_SIMD=scalar in the
/// environment forces the twin.
[[nodiscard]] const SplatKernels& best_kernels();

}  // namespace splatlas
