// Volume pass: sheet splatting and compositing of slices, front to back.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/fragment_shares.h"
#include "player/sheets/sheet_window.h"
#include "player/sheets/splat_kernels.h"
#include "player/spans/span_model.h"
#include "player/view/cut_rays.h"
#include "player/view/shear.h"

namespace splatlas {

struct SheetShares;
struct VoxelNumbers;

/// Shares of structures in the pixels of a sheet and in front of its fragments.
struct SharePass {
  const VoxelNumbers& numbers;
  SheetShares& shares;
  FragmentShares& of_fragments;
};

/// Weighted sum of the pixels at `upper`, to its right, and of the two pixels `row_floats` below. `color` is
/// the factor of white for 2 channels.
[[nodiscard]] inline Radiance sheet_sample(const float* upper, std::int64_t row_floats, std::int64_t channels,
                                           const std::array<float, 4>& weights,
                                           const std::array<float, 3>& color) {
  const float* lower = upper + row_floats;
  Radiance radiance;
  for (std::int64_t c = 0; c < channels; ++c) {
    radiance.rgba[static_cast<std::size_t>(c)] = weights[0] * upper[c] + weights[1] * upper[channels + c] +
                                                 weights[2] * lower[c] + weights[3] * lower[channels + c];
  }
  return channels == 4 ? radiance : in_color(radiance.rgba[0], radiance.rgba[1], color);
}

/// The finished sheet, with a transparent border of one pixel.
struct SheetImage {
  SheetWindow window;
  int channels = 4;                     ///< 4: red, green, blue, opacity; 2: white, opacity
  std::array<float, 3> color{1, 1, 1};  ///< factor of white
  std::vector<float> pixels;            ///< (fine_rows + 2) * (fine_columns + 2) * channels

  /// Row stride in pixels.
  [[nodiscard]] std::int64_t stride() const { return window.fine_columns() + 2; }
  /// Pixel (x, y), with -1 <= x <= fine_columns and -1 <= y <= fine_rows.
  [[nodiscard]] const float* at(std::int64_t x, std::int64_t y) const {
    return &pixels[static_cast<std::size_t>(((y + 1) * stride() + x + 1) * channels)];
  }
};

/// Splats the slices into sheets (Westover 1990) in sheared object space (Lacroute and Levoy 1994) and
/// composites them front to back. Also computes the radiance in front of every fragment; `fragments` must be
/// of the same window. A slab has the optical properties of its slice or, between two slices, those
/// interpolated at its centre. Early ray termination: blocks of pixels may stop at a transmittance of
/// `termination_threshold`. Bands of rows are independent and run in parallel; the result does not depend on
/// the number of threads. The planes of a cut clip the slabs (KeptSlabs). Returns the number of splatted
/// voxels, each counted once; with a cut, of spans that are not removed as a whole. Cost: visible voxels *
/// scale^2 * parts, plus fragments and pixels of the window. `shares`: also computes the shares of
/// structures; null: not asked for.
[[nodiscard]] std::uint64_t render_sheets(const SpanModel& model, const Shear& shear,
                                          const SheetWindow& window, const SplatKernels& kernels,
                                          float termination_threshold, std::span<const VoxelPlane> planes,
                                          FragmentOrder& fragments, SheetImage& image, ThreadPool& pool,
                                          const SharePass* shares = nullptr);

}  // namespace splatlas
