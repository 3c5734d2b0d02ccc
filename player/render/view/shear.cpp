#include "player/render/view/shear.h"

#include <cmath>

namespace splatlas {

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

}  // namespace splatlas
