// Rays of a parallel view in double precision.
#pragma once

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas::reference {

[[nodiscard]] double dot(const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 cross(const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 minus(const Vec3& a, const Vec3& b);

/// A ray in continuous voxel indices: index(s) = start + s * per_mm, with s in mm away from the viewer. The
/// plane of the picture centre has s = 0.
struct Ray {
  Vec3 start{0, 0, 0};
  Vec3 per_mm{0, 0, 0};

  [[nodiscard]] Vec3 at(double s_mm) const;
};

struct RayInterval {
  double from_mm = 0, to_mm = 0;

  [[nodiscard]] bool empty() const { return !(from_mm < to_mm); }
};
/// Clips an interval of a ray to the trilinear field of a grid, which ends one voxel outside it.
[[nodiscard]] RayInterval clip_to_field(const Ray& ray, const Index3& size, RayInterval interval);

/// The ray through picture coordinates (x, y). Pixel centres lie at integers plus one half.
[[nodiscard]] Ray ray_through(const ParallelView& view, const Grid& grid, double x, double y);

}  // namespace splatlas::reference
