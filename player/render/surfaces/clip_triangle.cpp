#include "player/render/surfaces/clip_triangle.h"

#include <cmath>

namespace splatlas {
namespace {

/// Limits slightly inside the guard band and the near plane, so that clipped corners satisfy both despite
/// rounding.
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

}  // namespace splatlas
