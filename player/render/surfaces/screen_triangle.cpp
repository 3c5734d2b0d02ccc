#include "player/render/surfaces/screen_triangle.h"

#include <tuple>

namespace splatlas {

TriangleAttributes::TriangleAttributes(const std::array<ScreenPoint, 3>& p,
                                       const std::array<double, 3>& depths, bool parallel,
                                       const ClippedTriangle* part)
    : parallel_(parallel), part_(part) {
  std::array<double, 3> depth = depths;
  std::tie(nearest_, furthest_) = std::minmax({depth[0], depth[1], depth[2]});
  x0_ = p[0].x;
  y0_ = p[0].y;
  const double x1 = p[1].x - x0_;
  const double y1 = p[1].y - y0_;
  const double x2 = p[2].x - x0_;
  const double y2 = p[2].y - y0_;
  const double area = x1 * y2 - y1 * x2;
  clockwise_ = area > 0;

  // Set up planes in screen space: depth, or depth / w and 1 / w in a perspective view
  const double per_area = area == 0 ? 0 : 1 / area;
  const auto plane_through = [&](const std::array<double, 3>& value) {
    const double rise_1 = (value[1] - value[0]) * per_area;
    const double rise_2 = (value[2] - value[0]) * per_area;
    return ScreenPlane{value[0], rise_1 * y2 - rise_2 * y1, rise_2 * x1 - rise_1 * x2};
  };
  if (parallel_) {
    depth_ = plane_through(depth);
    return;
  }
  for (std::size_t n = 0; n < 3; ++n) {
    per_w_[n] = 1 / p[n].w;
    depth[n] *= per_w_[n];
  }
  depth_ = plane_through(depth);
  inverse_w_ = plane_through(per_w_);
}

}  // namespace splatlas
