#include "tests/reference/perspective.h"

#include <cmath>
#include <numbers>

namespace splatlas::reference {

double PerspectiveView::distance_mm() const {
  const double half_height_mm = 0.5 * in_plane.size.height * in_plane.mm_per_pixel;
  return half_height_mm / std::tan(vertical_fov_deg * std::numbers::pi / 360);
}

Vec3 PerspectiveView::eye_lps_mm() const {
  Vec3 eye = in_plane.center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) eye[a] -= distance_mm() * in_plane.forward_lps[a];
  return eye;
}

Ray ray_through(const PerspectiveView& view, const Grid& grid, double x, double y) {
  const Vec3 eye = view.eye_lps_mm();
  Vec3 direction = minus(view.in_plane.point_lps_mm(x, y), eye);
  const double length = std::sqrt(dot(direction, direction));
  for (double& d : direction) d /= length;
  const Affine to_index = lps_mm_to_index(grid);
  return {to_index.apply(eye), to_index.apply_linear(direction)};
}

Ray ray_through(const View& view, double field_of_view_deg, const Grid& grid, double x, double y) {
  return view.eye_mm ? ray_through(PerspectiveView{view.plane, field_of_view_deg}, grid, x, y)
                     : ray_through(view.plane, grid, x, y);
}

}  // namespace splatlas::reference
