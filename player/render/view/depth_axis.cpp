#include "player/render/view/depth_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "player/render/view/shear.h"

namespace splatlas {
namespace {

/// Minimum slope of rays along the depth axis, in voxels per voxel along the principal axis of the ray. Below
/// it, depths do not locate a fragment on the ray.
constexpr double kMinSlope = 0.05;

/// The rays through the corners of the picture, in voxels: all others are between them.
std::array<Vec3, 4> corner_rays(const View& view, const Affine& to_index) {
  const ParallelView& plane = view.plane;
  const Vec3 eye = view.eye_lps_mm();
  std::array<Vec3, 4> rays{};
  for (std::size_t n = 0; n < rays.size(); ++n) {
    Vec3 ray = plane.point_lps_mm(n % 2 == 0 ? 0 : plane.size.width, n < 2 ? 0 : plane.size.height);
    for (std::size_t a = 0; a < 3; ++a) ray[a] -= eye[a];
    rays[n] = to_index.apply_linear(ray);
  }
  return rays;
}

double min_slope(const std::array<Vec3, 4>& rays, const DepthAxis& depth) {
  double slope = HUGE_VAL;
  for (const Vec3& ray : rays) {
    const double along = std::max({std::abs(ray[0]), std::abs(ray[1]), std::abs(ray[2])});
    slope = std::min(slope, depth.sign * ray[depth.axis] / along);
  }
  return slope;
}

}  // namespace

std::optional<DepthAxis> depth_axis(const View& view, const Grid& grid) {
  const Shear shear = factorise(view.plane, grid);
  const DepthAxis principal{shear.scan.slice_axis, shear.ascending ? 1.0 : -1.0};
  if (!view.eye_mm) return principal;
  const Affine to_index = lps_mm_to_index(grid);
  const std::array<Vec3, 4> rays = corner_rays(view, to_index);
  if (min_slope(rays, principal) >= kMinSlope) return principal;

  const Vec3 middle = to_index.apply_linear(view.plane.forward_lps);
  DepthAxis best;
  double best_slope = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const DepthAxis depth{a, middle[a] < 0 ? -1.0 : 1.0};
    if (const double slope = min_slope(rays, depth); slope > best_slope) {
      best = depth;
      best_slope = slope;
    }
  }
  return best_slope >= kMinSlope ? std::optional(best) : std::nullopt;
}

}  // namespace splatlas
