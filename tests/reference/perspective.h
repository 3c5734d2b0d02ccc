// Rays of a perspective view in double precision.
#pragma once

#include "player/camera.h"
#include "tests/reference/ray.h"

namespace splatlas::reference {

/// Perspective view that matches a parallel view in the plane of its centre.
struct PerspectiveView {
  ParallelView in_plane;         ///< the view in the plane of the centre
  double vertical_fov_deg = 30;  ///< full angle, in (0, 180)

  /// Distance from the eye to the plane of the centre.
  [[nodiscard]] double distance_mm() const;
  [[nodiscard]] Vec3 eye_lps_mm() const;
};

/// The ray from the eye (s = 0) through picture coordinates (x, y) of the plane of the centre, with s in mm.
[[nodiscard]] Ray ray_through(const PerspectiveView& view, const Grid& grid, double x, double y);

/// The ray of a view in either projection. The eye follows from the field of view, not from `view`.
[[nodiscard]] Ray ray_through(const View& view, double field_of_view_deg, const Grid& grid, double x,
                              double y);

}  // namespace splatlas::reference
