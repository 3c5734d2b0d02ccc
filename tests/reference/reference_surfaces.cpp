#include "tests/reference/reference_surfaces.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "format/content/decision_tree.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {
namespace {

constexpr double kSubPixels = 256;
/// Surfaces coincide if their depths share an interval of 1/4096 voxel. An offset keeps the interval borders
/// off common depths, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;

struct Point {
  double x = 0, y = 0;
};

/// Barycentric coordinates of a pixel centre in three points; nothing outside.
std::optional<std::array<double, 3>> weights_in(const std::array<Point, 3>& corner, double x, double y) {
  const auto doubled_area = [](const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const double whole = doubled_area(corner[0], corner[1], corner[2]);
  if (whole == 0 || !std::isfinite(whole)) return std::nullopt;
  std::array<double, 3> weights{};
  for (std::size_t n = 0; n < 3; ++n) {
    const Point& a = corner[(n + 1) % 3];
    const Point& b = corner[(n + 2) % 3];
    weights[n] = doubled_area(a, b, {x, y}) / whole;
    // A centre on an edge counts as moved by (e, e^2) for infinitesimal e > 0.
    double inside = weights[n];
    if (inside == 0) inside = -(b.y - a.y) / whole;
    if (inside == 0) inside = (b.x - a.x) / whole;
    if (inside < 0) return std::nullopt;
  }
  return weights;
}

/// Linear interpolation between three points, clamped to their values: snapping moves centres in and out.
double plane_at(const std::array<Point, 3>& corner, const std::array<double, 3>& value, double x, double y) {
  const Point p{corner[1].x - corner[0].x, corner[1].y - corner[0].y};
  const Point q{corner[2].x - corner[0].x, corner[2].y - corner[0].y};
  const double area = p.x * q.y - p.y * q.x;
  const auto [low, high] = std::minmax({value[0], value[1], value[2]});
  if (area == 0) return low;
  const double along_p = ((x - corner[0].x) * q.y - (y - corner[0].y) * q.x) / area;
  const double along_q = ((y - corner[0].y) * p.x - (x - corner[0].x) * p.y) / area;
  const double at = value[0] + along_p * (value[1] - value[0]) + along_q * (value[2] - value[0]);
  return std::clamp(at, low, high);
}

}  // namespace

SurfacesInView::SurfacesInView(const AtlasContent& content, const Selection& selection,
                               const ParallelView& view, Axis principal, Coverage coverage)
    : view_(view), selection_(selection), to_lps_(index_to_lps_mm(storage_grid(content))) {
  const Grid grid = storage_grid(content);
  const auto axis = static_cast<std::size_t>(principal);
  const double away = ray_through(view, grid, 0, 0).per_mm[axis] < 0 ? -1 : 1;

  const auto snapped = [&](double coordinate) {  // pixel centres are multiples
    if (coverage == Coverage::kExact) return coordinate;
    return std::nearbyint((coordinate - 0.5) * kSubPixels) / kSubPixels + 0.5;
  };
  const DrawPlan plan = DecisionTree(content.graph, content.classes).plan(selection);
  for (const StructureIndex s : plan.surfaces) {
    Surface surface{&content.surfaces[s], s, {}};
    for (const auto& p : content.surfaces[s].positions_ijk) {
      const Vec3 from_center = minus(to_lps_.apply({p[0], p[1], p[2]}), view.center_lps_mm);
      const double x = 0.5 * view.size.width + dot(from_center, view.right_lps) / view.mm_per_pixel;
      const double y = 0.5 * view.size.height - dot(from_center, view.up_lps) / view.mm_per_pixel;
      surface.vertices.push_back(
          {x, y, snapped(x), snapped(y), dot(from_center, view.forward_lps), away * p[axis]});
    }
    surfaces_.push_back(std::move(surface));
  }
  list_rows();
}

void SurfacesInView::list_rows() {
  rows_.resize(static_cast<std::size_t>(view_.size.height));
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const auto& triangles = surfaces_[s].mesh->triangles;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      double top = view_.size.height;
      double bottom = 0;
      for (const std::uint32_t corner : triangles[t]) {
        top = std::min(top, surfaces_[s].vertices[corner].covered_y);
        bottom = std::max(bottom, surfaces_[s].vertices[corner].covered_y);
      }
      for (int row = 0; row < view_.size.height; ++row) {
        if (row + 1 >= top && row <= bottom) rows_[static_cast<std::size_t>(row)].push_back({s, t});
      }
    }
  }
}

void SurfacesInView::cross(const Surface& surface, std::uint32_t triangle, double x, double y,
                           std::vector<Crossing>& out) const {
  const auto& corner = surface.mesh->triangles[triangle];
  std::array<Point, 3> seen{};
  std::array<Point, 3> covered{};
  std::array<double, 3> s_mm{};
  std::array<double, 3> depth{};
  for (std::size_t n = 0; n < 3; ++n) {
    const Seen& vertex = surface.vertices[corner[n]];
    seen[n] = {vertex.x, vertex.y};
    covered[n] = {vertex.covered_x, vertex.covered_y};
    s_mm[n] = vertex.s_mm;
    depth[n] = vertex.depth;
  }
  const auto weights = weights_in(covered, x, y);
  if (!weights) return;
  Crossing crossing;
  crossing.s_mm = plane_at(seen, s_mm, x, y);
  crossing.depth = plane_at(seen, depth, x, y);
  crossing.structure = surface.structure;
  crossing.triangle = triangle;
  std::array<Vec3, 3> corners{}, normals{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto& position = surface.mesh->positions_ijk[corner[n]];
    corners[n] = to_lps_.apply({position[0], position[1], position[2]});
    for (std::size_t a = 0; a < 3; ++a) normals[n][a] = surface.mesh->normals_lps[corner[n]][a];
  }
  crossing.entering = meets_front(*surface.mesh, corners, normals, view_.forward_lps);
  shade(crossing, view_, selection_, normals, *weights);
  out.push_back(crossing);
}

bool meets_front(const SurfaceMesh& mesh, const std::array<Vec3, 3>& corners_lps,
                 const std::array<Vec3, 3>& normals_lps, const Vec3& along_lps) {
  const Vec3 front = cross(minus(corners_lps[1], corners_lps[0]), minus(corners_lps[2], corners_lps[0]));
  const bool is_derived =
      mesh.position_scale == 4 || mesh.position_scale == 128 || mesh.position_scale == 256;
  double outwards = is_derived ? 1 : 0;
  for (const Vec3& normal : normals_lps) outwards += is_derived ? 0 : dot(front, normal);
  return outwards > 0 ? dot(front, along_lps) <= 0 : !(outwards < 0) || dot(front, along_lps) > 0;
}

void shade(Crossing& crossing, const ParallelView& view, const Selection& selection,
           const std::array<Vec3, 3>& normals_lps, const std::array<double, 3>& weights) {
  Vec3 normal{0, 0, 0};  // of the visible side
  for (std::size_t n = 0; n < 3; ++n) {
    const double weight = crossing.entering ? weights[n] : -weights[n];
    for (std::size_t a = 0; a < 3; ++a) normal[a] += weight * normals_lps[n][a];
  }
  const StructureDraw& draw = selection.structures[crossing.structure];
  double opacity = draw.opacity.value_or(draw.ghost ? kGhostOpacity : 1.0f);
  std::array<double, 3> color = shade_surface(view, linear_of(draw.color), normal);
  crossing.hull.reset();
  if (draw.ghost) {
    crossing.hull = draw.term;
    color = linear_of(draw.color);
    const double length = std::sqrt(dot(normal, normal));
    const double facing = length > 0 ? std::min(1.0, std::abs(dot(normal, view.forward_lps)) / length) : 1;
    opacity *= 0.06 + 0.94 * (1 - facing) * (1 - facing);
  }
  crossing.rgba = {color[0] * opacity, color[1] * opacity, color[2] * opacity, opacity};
}

void put_in_order(std::vector<Crossing>& all) {
  const auto order = [](const Crossing& c) {
    const double step = std::floor(c.depth * kDepthSteps + kDepthOffset);
    return std::tuple(step, c.entering, c.structure, c.triangle);
  };
  std::sort(all.begin(), all.end(),
            [&](const Crossing& a, const Crossing& b) { return order(a) < order(b); });
  std::set<std::uint32_t> hulls;
  std::erase_if(all, [&](const Crossing& c) { return c.hull && !hulls.insert(*c.hull).second; });
  const auto opaque = std::find_if(all.begin(), all.end(), [](const Crossing& c) { return c.rgba[3] >= 1; });
  if (opaque != all.end()) all.erase(opaque + 1, all.end());
}

std::vector<Crossing> SurfacesInView::crossings(double x, double y, const RayInterval& kept) const {
  std::vector<Crossing> all;
  for (const TriangleRef& ref : rows_[static_cast<std::size_t>(y)]) {
    cross(surfaces_[ref.surface], ref.triangle, x, y, all);
  }
  std::erase_if(all, [&](const Crossing& c) { return !(c.s_mm >= kept.from_mm && c.s_mm <= kept.to_mm); });
  put_in_order(all);
  return all;
}

}  // namespace splatlas::reference
