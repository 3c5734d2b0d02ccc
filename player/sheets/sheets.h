// Volume pass: sheet splatting and compositing of slices, front to back.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/sheets/fragment_order.h"
#include "player/sheets/splat_kernels.h"
#include "player/spans/span_model.h"
#include "player/view/shear.h"

namespace splatlas {

/// Sampling density of a volume.
struct SheetSampling {
  int scale = 1;       ///< pixels per voxel along each axis
  int parts = 1;       ///< slabs per slice: see Slabs
  bool cubic = false;  ///< bicubic warp of pixels without fragments: see WarpKernels::cubic
};

/// The rectangle of the (u, v) plane that sheets cover. Sheet pixel (x, y) is at u = u0 + x / scale,
/// v = v0 + y / scale. A sheet of scale s consists of s * s interleaved sheets of one pixel per voxel. Such a
/// phase has the same sub-pixel offset at all pixels. sheet_weights() interpolates between pixels.
struct SheetWindow : SheetSampling {
  std::int64_t u0 = 0, v0 = 0;
  std::int64_t columns = 0, rows = 0;  ///< in voxels
  float skew = 0;

  [[nodiscard]] bool empty() const { return columns <= 0 || rows <= 0; }
  [[nodiscard]] std::int64_t fine_columns() const { return columns * scale; }
  [[nodiscard]] std::int64_t fine_rows() const { return rows * scale; }
};

/// Interpolation weights of the upper left, upper right, lower left and lower right neighbour. Bilinear
/// weights, with `skew` moved from one diagonal to the other, limited so that no weight is negative.
[[nodiscard]] inline std::array<float, 4> sheet_weights(float x_part, float y_part, float skew) {
  const float x_rest = 1 - x_part, y_rest = 1 - y_part;
  const std::array<float, 4> bilinear{x_rest * y_rest, x_part * y_rest, x_rest * y_part, x_part * y_part};
  const float bounded =
      std::clamp(skew, -std::min(bilinear[0], bilinear[3]), std::min(bilinear[1], bilinear[2]));
  return {bilinear[0] + bounded, bilinear[1] - bounded, bilinear[2] - bounded, bilinear[3] + bounded};
}

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

/// The window of all footprints of the model that overlap the picture.
[[nodiscard]] SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                                       const SheetSampling& sampling);

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
/// the number of threads. Returns the number of splatted voxels, each counted once. Cost: visible voxels *
/// scale^2 * parts, plus fragments and pixels of the window.
[[nodiscard]] std::uint64_t render_sheets(const SpanModel& model, const Shear& shear,
                                          const SheetWindow& window, const SplatKernels& kernels,
                                          float termination_threshold, FragmentOrder& fragments,
                                          SheetImage& image, ThreadPool& pool);

}  // namespace splatlas
