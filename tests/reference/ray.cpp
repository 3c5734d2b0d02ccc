#include "tests/reference/ray.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace splatlas::reference {

Vec3 minus(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vec3 Ray::at(double s_mm) const {
  return {start[0] + s_mm * per_mm[0], start[1] + s_mm * per_mm[1], start[2] + s_mm * per_mm[2]};
}

RayInterval clip_to_field(const Ray& ray, const Index3& size, RayInterval interval) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto last = static_cast<double>(size[a]);
    if (ray.per_mm[a] == 0) {
      if (!(ray.start[a] > -1 && ray.start[a] < last)) return {};
      continue;
    }
    const double first_mm = (-1 - ray.start[a]) / ray.per_mm[a];
    const double last_mm = (last - ray.start[a]) / ray.per_mm[a];
    interval.from_mm = std::max(interval.from_mm, std::min(first_mm, last_mm));
    interval.to_mm = std::min(interval.to_mm, std::max(first_mm, last_mm));
  }
  return interval;
}

Ray ray_through(const ParallelView& view, const Grid& grid, double x, double y) {
  const Affine to_index = lps_mm_to_index(grid);
  return {to_index.apply(view.point_lps_mm(x, y)), to_index.apply_linear(view.forward_lps)};
}

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
