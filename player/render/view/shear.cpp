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

Shear factorise(const ParallelView& view, const Grid& grid, const Axis* forced) {
  const Affine to_index = lps_mm_to_index(grid);
  const Vec3 ray = to_index.apply_linear(view.forward_lps);  // voxels per mm

  // Choose the principal axis: the largest component of the ray in object space
  Shear shear;
  std::size_t principal = 2;
  for (const std::size_t axis : {1u, 0u}) {
    if (std::abs(ray[axis]) > std::abs(ray[principal])) principal = axis;
  }
  shear.principal = forced ? *forced : static_cast<Axis>(principal);
  shear.scan = ScanOrder::of(shear.principal);

  // Compute the shear and the distance between slices on a ray
  const double along = ray[shear.scan.slice_axis];
  shear.ascending = along > 0;
  shear.slope_u = ray[shear.scan.scan_axis] / along;
  shear.slope_v = ray[shear.scan.row_axis] / along;
  shear.k_ref = 0.5 * static_cast<double>(grid.size[shear.scan.slice_axis] - 1);
  shear.slab_mm = 1.0 / std::abs(along);

  // Determine the affine warp from three corners of the picture
  const auto to_sheet = [&](double x, double y) -> std::array<double, 2> {
    const Vec3 index = to_index.apply(view.point_lps_mm(x, y));
    const double k = index[shear.scan.slice_axis];
    return {index[shear.scan.scan_axis] + shear.u_shift(k), index[shear.scan.row_axis] + shear.v_shift(k)};
  };
  const double width = view.size.width;
  const double height = view.size.height;
  const auto corner = to_sheet(0, 0);
  const auto right = to_sheet(width, 0);
  const auto bottom = to_sheet(0, height);
  shear.picture_to_sheet = {(right[0] - corner[0]) / width, (bottom[0] - corner[0]) / height, corner[0],
                            (right[1] - corner[1]) / width, (bottom[1] - corner[1]) / height, corner[1]};
  return shear;
}

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
