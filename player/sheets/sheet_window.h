// Window of a sheet: the rectangle of sheared object space that it covers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "player/camera.h"
#include "player/spans/span_model.h"
#include "player/view/cut_rays.h"
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

/// The window of all footprints of the model that overlap the picture, without those that `planes` remove.
[[nodiscard]] SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                                       const SheetSampling& sampling,
                                       std::span<const VoxelPlane> planes = {});

}  // namespace splatlas
