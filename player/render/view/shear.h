// Shear-warp factorisation of a parallel view, and grid axis of the depths of fragments.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
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

}  // namespace splatlas
