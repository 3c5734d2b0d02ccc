// Perspective views, in double precision.
#pragma once

#include "player/camera.h"
#include "tests/reference/ray.h"

namespace splatlas::reference {

/// An eye that sees what a parallel view sees, exactly so in the plane of its centre.
struct PerspectiveView {
  ParallelView in_plane;         ///< what the plane of the centre looks like
  double vertical_fov_deg = 30;  ///< whole angle, above 0 and below 180

  /// From the eye to the plane of the centre.
  [[nodiscard]] double distance_mm() const;
  [[nodiscard]] Vec3 eye_lps_mm() const;
};

/// From the eye (s = 0) through picture coordinates (x, y) of the plane of the centre; s in mm along the ray.
[[nodiscard]] Ray ray_through(const PerspectiveView& view, const Grid& grid, double x, double y);

}  // namespace splatlas::reference
