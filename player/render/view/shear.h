// Shear-warp factorisation of a parallel view, grid axis of the depths of fragments, and window of a sheet
// with the places of its rows, pixels and samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "player/camera.h"

namespace splatlas {

/// An affine map of the plane.
struct Affine2 {
  double xx = 1, xy = 0, x0 = 0;  ///< x' = xx * x + xy * y + x0
  double yx = 0, yy = 1, y0 = 0;  ///< y' = yx * x + yy * y + y0
};

/// Sheared object space (Lacroute and Levoy 1994), in voxels. Voxel (scan i, row j) of slice k lies at
///   u = i - slope_u * (k - k_ref),   v = j - slope_v * (k - k_ref).
/// Points on one ray share (u, v). The principal axis maximises the number of slices that a ray crosses, so
/// that slopes are within [-1, 1].
struct Shear {
  Axis principal = Axis::kZ;
  ScanOrder scan = ScanOrder::of(Axis::kZ);
  bool ascending = true;  ///< front-to-back order of slices is ascending
  double slope_u = 0, slope_v = 0;
  double k_ref = 0;          ///< slice that the shear leaves in place
  double slab_mm = 1;        ///< length of a ray between two slices
  Affine2 picture_to_sheet;  ///< the inverse warp: picture coordinates (pixels) to (u, v)

  /// Width of a voxel in picture pixels: the largest along the axes of the picture.
  [[nodiscard]] double voxel_pixels() const {
    const auto [along_width, along_height] = voxels_per_pixel();
    return 1 / std::min(along_width, along_height);
  }
  /// Voxels along a pixel's width and height.
  [[nodiscard]] std::array<double, 2> voxels_per_pixel() const {
    const Affine2& map = picture_to_sheet;
    return {std::hypot(map.xx, map.yx), std::hypot(map.xy, map.yy)};
  }
  [[nodiscard]] double u_shift(double k) const { return -slope_u * (k - k_ref); }
  [[nodiscard]] double v_shift(double k) const { return -slope_v * (k - k_ref); }
};

/// Maximum slope for a forced principal axis, in voxels per slice: about half a degree from its slices.
inline constexpr double kMaxForcedSlope = 100;

/// Factorises a view of `grid`. `forced`: the principal axis, for measurements; slopes may then exceed 1.
[[nodiscard]] Shear factorise(const ParallelView& view, const Grid& grid, const Axis* forced = nullptr);

struct DepthAxis {
  std::size_t axis = 2;
  double sign = 1;  ///< depth is sign * index along the axis: it increases along every ray
};

/// The principal axis of a view. If some rays of a perspective view run along its planes of voxels, where
/// depths locate no fragment: the axis whose planes all rays cross most steeply. None if there is none.
[[nodiscard]] std::optional<DepthAxis> depth_axis(const View& view, const Grid& grid);

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

/// Picture coordinates to sheet pixels.
[[nodiscard]] inline Affine2 picture_to_pixels(const Shear& shear, const SheetWindow& window) {
  const Affine2& map = shear.picture_to_sheet;
  const double scale = window.scale;
  return {map.xx * scale, map.xy * scale, (map.x0 - static_cast<double>(window.u0)) * scale,
          map.yx * scale, map.yy * scale, (map.y0 - static_cast<double>(window.v0)) * scale};
}

/// Maximum distance in the sheet, in its pixels, of adjacent picture pixels.
[[nodiscard]] inline double longest_step(const Affine2& map) {
  return std::max(std::hypot(map.xx, map.yx), std::hypot(map.xy, map.yy));
}

/// Samples of a picture pixel along each axis, by its width in voxels: finer sheets add no detail.
[[nodiscard]] inline int samples_per_side(const Affine2& map, const SheetWindow& window) {
  constexpr double kMaxSamplesPerSide = 16;
  const double voxels = longest_step(map) / window.scale;
  return static_cast<int>(std::clamp(std::ceil(voxels - 0.25), 1.0, kMaxSamplesPerSide));
}

/// Positions of a slice's voxel rows among the fine rows. There are `scale` fine rows per voxel row.
class SliceRows {
 public:
  /// `k`: position of the slab along the principal axis.
  SliceRows(const Shear& shear, const SheetWindow& window, double k) : scale_(window.scale) {
    // Find the continuous fine row of voxel row 0
    const double fine = (shear.v_shift(k) - static_cast<double>(window.v0)) * static_cast<double>(scale_);
    first_ = static_cast<std::int64_t>(std::ceil(fine));
    rest_ = static_cast<double>(first_) - fine;
  }

  /// The n-th fine row between voxel rows `upper` and `upper` + 1.
  [[nodiscard]] std::int64_t fine_row(std::int64_t upper, std::int64_t n) const {
    return first_ + upper * scale_ + n;
  }
  /// The first voxel row whose n-th fine row is at or below `row`.
  [[nodiscard]] std::int64_t upper_from(std::int64_t n, std::int64_t row) const {
    const std::int64_t rows = row - n - first_;
    return rows >= 0 ? (rows + scale_ - 1) / scale_ : -(-rows / scale_);
  }
  /// Weight of the lower voxel row at the n-th fine row.
  [[nodiscard]] float lower_weight(std::int64_t n) const {
    return static_cast<float>((rest_ + static_cast<double>(n)) / static_cast<double>(scale_));
  }

 private:
  std::int64_t scale_, first_ = 0;
  double rest_ = 0;
};

}  // namespace splatlas
