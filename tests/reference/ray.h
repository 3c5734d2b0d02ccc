// Rays of a view in double precision.
#pragma once

#include <limits>

#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas::reference {

[[nodiscard]] Vec3 minus(const Vec3& a, const Vec3& b);

/// A ray in voxel indices: index(s) = start + s * per_mm, s in mm behind the plane of the picture centre.
struct Ray {
  Vec3 start{0, 0, 0};
  Vec3 per_mm{0, 0, 0};

  [[nodiscard]] Vec3 at(double s_mm) const;
};

struct RayInterval {
  double from_mm = 0, to_mm = 0;

  [[nodiscard]] bool empty() const { return !(from_mm < to_mm); }
};
inline constexpr RayInterval kWholeRay{-std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::infinity()};
/// Clips an interval of a ray to the trilinear field of a grid, which ends one voxel outside it.
[[nodiscard]] RayInterval clip_to_field(const Ray& ray, const Index3& size, RayInterval interval);

/// The ray through picture coordinates (x, y). Pixel centres lie at integers plus one half.
[[nodiscard]] Ray ray_through(const ParallelView& view, const Grid& grid, double x, double y);

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
