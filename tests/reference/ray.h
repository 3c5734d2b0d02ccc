// Rays of a parallel view, in double precision.
#pragma once

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas::reference {

[[nodiscard]] double dot(const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 cross(const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 minus(const Vec3& a, const Vec3& b);

/// A ray in continuous voxel indices: index(s) = start + s * per_mm, s in mm away from the viewer; s = 0 is
/// in the plane of the picture's centre.
struct Ray {
  Vec3 start{0, 0, 0};
  Vec3 per_mm{0, 0, 0};

  [[nodiscard]] Vec3 at(double s_mm) const;
};

/// The ray through picture coordinates (x, y); a pixel's centre is at its number plus one half.
[[nodiscard]] Ray ray_through(const ParallelView& view, const Grid& grid, double x, double y);

}  // namespace splatlas::reference
