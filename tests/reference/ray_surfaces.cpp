#include "tests/reference/ray_surfaces.h"

#include <algorithm>
#include <cmath>

#include "format/content/decision_tree.h"

namespace splatlas::reference {

RaySurfaces::RaySurfaces(const AtlasContent& content, const Selection& selection, const View& view)
    : plane_(view.plane), selection_(selection) {
  const Grid grid = storage_grid(content);
  to_lps_ = index_to_lps_mm(grid);
  depth_ = depth_axis(view, grid).value_or(DepthAxis{});
  for (const StructureIndex s : DecisionTree(content.graph, content.classes).plan(selection).surfaces)
    add(content.surfaces[s], s);
}

void RaySurfaces::add(const SurfaceMesh& mesh, StructureIndex structure) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle triangle;
    triangle.mesh = &mesh;
    triangle.structure = structure;
    triangle.number = t;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t corner = mesh.triangles[t][n];
      for (std::size_t a = 0; a < 3; ++a) {
        triangle.corner_ijk[n][a] = mesh.positions_ijk[corner][a];
        triangle.normal_lps[n][a] = mesh.normals_lps[corner][a];
      }
      triangle.corner_lps[n] = to_lps_.apply(triangle.corner_ijk[n]);
    }
    triangles_.push_back(triangle);
  }
}

std::optional<RaySurfaces::Hit> RaySurfaces::hit(const Triangle& triangle, const Ray& ray) {
  const Vec3& origin = triangle.corner_ijk[0];
  const Vec3 p = minus(triangle.corner_ijk[1], origin);
  const Vec3 q = minus(triangle.corner_ijk[2], origin);
  const Vec3 across = cross(ray.per_mm, q);
  const double volume = dot(p, across);
  if (volume == 0) return std::nullopt;
  const Vec3 from_origin = minus(ray.start, origin);
  const Vec3 beside = cross(from_origin, p);
  Hit hit{{0, dot(from_origin, across) / volume, dot(ray.per_mm, beside) / volume}, dot(q, beside) / volume};
  hit.weight[0] = 1 - hit.weight[1] - hit.weight[2];
  return hit;
}

bool RaySurfaces::near_edge(const Ray& ray, const Ray& beside, const Ray& below) const {
  return std::any_of(triangles_.begin(), triangles_.end(), [&](const Triangle& triangle) {
    const auto at = hit(triangle, ray), right = hit(triangle, beside), down = hit(triangle, below);
    if (!at || !right || !down) return false;
    bool on_edge = false;
    for (std::size_t n = 0; n < 3; ++n) {
      const double weight = at->weight[n];
      const double change = std::abs(right->weight[n] - weight) + std::abs(down->weight[n] - weight);
      if (weight < -change) return false;
      on_edge = on_edge || weight < change;
    }
    return on_edge;
  });
}

std::vector<Crossing> RaySurfaces::crossings(const Ray& ray, const RayInterval& kept) const {
  const Vec3 along_lps = to_lps_.apply_linear(ray.per_mm);
  std::vector<Crossing> all;
  for (const Triangle& triangle : triangles_) {
    const std::optional<Hit> met = hit(triangle, ray);
    if (!met) continue;
    const auto& [weight, s_mm] = *met;
    if (!(std::min({weight[0], weight[1], weight[2]}) >= 0) || !(s_mm >= kept.from_mm && s_mm <= kept.to_mm))
      continue;
    Crossing crossing;
    crossing.s_mm = s_mm;
    crossing.depth = depth_.sign * ray.at(s_mm)[depth_.axis];
    crossing.structure = triangle.structure;
    crossing.triangle = triangle.number;
    crossing.entering = meets_front(*triangle.mesh, triangle.corner_lps, triangle.normal_lps, along_lps);
    shade(crossing, plane_, selection_, triangle.normal_lps, weight);
    all.push_back(crossing);
  }
  put_in_order(all);
  return all;
}

}  // namespace splatlas::reference
