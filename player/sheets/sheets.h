// The volume pass: slices front to back, each splatted into a sheet and composited under what is in front of
// it.
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

/// How finely a volume is sampled.
struct SheetSampling {
  int scale = 1;       ///< pixels per voxel along each axis
  int parts = 1;       ///< slabs per slice: see Slabs
  bool cubic = false;  ///< where there are no fragments, places see 4 x 4 pixels: see WarpKernels::cubic
};

/// The part of the (u, v) plane that sheets cover. Sheet pixel (x, y) stands at u = u0 + x / scale,
/// v = v0 + y / scale. A sheet of scale s is s * s interleaved sheets of one pixel per voxel ("phases"), each
/// with one sub-pixel offset for all its pixels. Places between pixels see their four neighbours: see
/// sheet_weights().
struct SheetWindow : SheetSampling {
  std::int64_t u0 = 0, v0 = 0;
  std::int64_t columns = 0, rows = 0;  ///< in voxels
  float skew = 0;

  [[nodiscard]] bool empty() const { return columns <= 0 || rows <= 0; }
  [[nodiscard]] std::int64_t fine_columns() const { return columns * scale; }
  [[nodiscard]] std::int64_t fine_rows() const { return rows * scale; }
};

/// Weights of the upper left, upper right, lower left and lower right neighbour of a place between them:
/// bilinear ones, and `skew` taken from one diagonal and given to the other, as far as no weight falls below
/// 0.
[[nodiscard]] inline std::array<float, 4> sheet_weights(float x_part, float y_part, float skew) {
  const float x_rest = 1 - x_part, y_rest = 1 - y_part;
  const std::array<float, 4> bilinear{x_rest * y_rest, x_part * y_rest, x_rest * y_part, x_part * y_part};
  const float bounded =
      std::clamp(skew, -std::min(bilinear[0], bilinear[3]), std::min(bilinear[1], bilinear[2]));
  return {bilinear[0] + bounded, bilinear[1] - bounded, bilinear[2] - bounded, bilinear[3] + bounded};
}

/// The window that covers where the model's voxels are seen, as far as the picture shows them.
[[nodiscard]] SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                                       const SheetSampling& sampling);

/// The finished sheet, with a border of one pixel that nothing covers.
struct SheetImage {
  SheetWindow window;
  int channels = 4;                     ///< 4: red, green, blue, opacity; 2: white, opacity
  std::array<float, 3> color{1, 1, 1};  ///< what white stands for
  std::vector<float> pixels;            ///< (fine_rows + 2) * (fine_columns + 2) * channels

  /// Pixels from one row to the next.
  [[nodiscard]] std::int64_t stride() const { return window.fine_columns() + 2; }
  /// x and y from -1 to fine_columns and fine_rows, both included.
  [[nodiscard]] const float* at(std::int64_t x, std::int64_t y) const {
    return &pixels[static_cast<std::size_t>(((y + 1) * stride() + x + 1) * channels)];
  }
};

struct SheetCounters {
  std::uint64_t voxels = 0;  ///< splatted, each counted once however many sheet pixels it covers
};

/// Renders the volume in the window, and the volume in front of every fragment. Bands of rows run in parallel
/// and share nothing: the result does not depend on the number of threads. Blocks of pixels that let through
/// no more than `floor` are left as they are. `fragments` are of the same window. Slabs around slices have
/// their light; those between slices the light halfway through, interpolated. Cost: voxels seen * scale^2 *
/// parts, plus fragments, plus the window's pixels.
[[nodiscard]] SheetCounters render_sheets(const SpanModel& model, const Shear& shear,
                                          const SheetWindow& window, const SplatKernels& kernels, float floor,
                                          FragmentOrder& fragments, SheetImage& image, ThreadPool& pool);

}  // namespace splatlas
