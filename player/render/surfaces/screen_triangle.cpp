#include "player/render/surfaces/screen_triangle.h"

#include <tuple>

namespace splatlas {
namespace {

/// Limits slightly inside guard band and near plane, so that clipped corners satisfy both despite rounding.
constexpr double kClipExtent = kGuardBand - 2;
constexpr double kNearest = kNearPlane * (1 + 1e-9);

struct Corner {
  ScreenPoint point;  ///< homogeneous
  std::array<double, 3> weights{};
};

/// A clip plane: points with a value >= 0 are inside.
using Side = double (*)(const ScreenPoint& p);
constexpr std::array<Side, 5> kSides{
    [](const ScreenPoint& p) { return p.w - kNearest; },
    [](const ScreenPoint& p) { return kClipExtent * p.w - p.x; },
    [](const ScreenPoint& p) { return kClipExtent * p.w + p.x; },
    [](const ScreenPoint& p) { return kClipExtent * p.w - p.y; },
    [](const ScreenPoint& p) { return kClipExtent * p.w + p.y; },
};

Corner between(const Corner& a, const Corner& b, double share) {
  const auto mix = [share](double from, double to) { return from + share * (to - from); };
  Corner corner;
  corner.point = {mix(a.point.x, b.point.x), mix(a.point.y, b.point.y), mix(a.point.w, b.point.w)};
  for (std::size_t n = 0; n < 3; ++n) corner.weights[n] = mix(a.weights[n], b.weights[n]);
  return corner;
}

std::vector<Corner> clip(const std::vector<Corner>& polygon, Side side) {
  std::vector<Corner> inside;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Corner& a = polygon[n];
    const Corner& b = polygon[(n + 1) % polygon.size()];
    const double of_a = side(a.point);
    const double of_b = side(b.point);
    if (of_a >= 0) inside.push_back(a);
    // Interpolate from the inner to the outer end, for the same result in both neighbours of the edge.
    if (of_a >= 0 && of_b < 0) inside.push_back(between(a, b, of_a / (of_a - of_b)));
    if (of_a < 0 && of_b >= 0) inside.push_back(between(b, a, of_b / (of_b - of_a)));
  }
  return inside;
}

}  // namespace

void clip_triangle(const SurfaceMesh& mesh, std::uint32_t triangle, const Projection& projection,
                   std::vector<ClippedTriangle>& parts) {
  std::vector<Corner> polygon(3);
  for (std::size_t n = 0; n < 3; ++n) {
    polygon[n].point = projection.homogeneous(mesh.positions_ijk[mesh.triangles[triangle][n]]);
    const auto [x, y, w] = polygon[n].point;
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(w)) return;
    polygon[n].weights[n] = 1;
  }

  // Clip against each plane
  for (const Side side : kSides) {
    polygon = clip(polygon, side);
    if (polygon.size() < 3) return;
  }

  // Split the convex polygon into a fan of triangles
  for (std::size_t n = 2; n < polygon.size(); ++n) {
    ClippedTriangle& part = parts.emplace_back();
    part.triangle = triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      const Corner& corner = polygon[c == 0 ? 0 : n - 2 + c];
      const auto [x, y, w] = corner.point;
      part.corner[c] = {x / w, y / w, w};
      part.weights[c] = corner.weights;
    }
  }
}

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
