#include "tests/reference/reference_cut.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "format/content/decision_tree.h"
#include "player/transfer_function.h"
#include "tests/reference/optical_field.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double linear_of_grey(double encoded) {
  const double e = std::clamp(encoded, 0.0, 1.0);
  return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
}

/// Decides between voxels at the same distance, and between both sides of a surface in the plane.
constexpr double kTie = 1e-6;

IndexPlane slightly_inside(const IndexPlane& plane) {
  return {plane.normal, plane.offset - kTie};
}

}  // namespace

ReferenceCut::ReferenceCut(const AtlasContent& content, const Selection& selection,
                           const RenderOptions& options)
    : content_(content), selection_(selection), caps_(options.caps), grid_(storage_grid(content)) {
  const Affine to_lps = index_to_lps_mm(grid_);
  for (const CutPlane& plane : options.cuts) {
    IndexPlane of_index;
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 axis{};
      axis[a] = 1;
      of_index.normal[a] = dot(plane.normal_lps, to_lps.apply_linear(axis));
    }
    const double length = std::sqrt(dot(of_index.normal, of_index.normal));
    of_index.offset = (plane.offset_mm - dot(plane.normal_lps, to_lps.offset)) / length;
    for (double& component : of_index.normal) component /= length;
    planes_.push_back(of_index);
  }
  solids_ = DecisionTree(content.graph, content.classes).plan(selection).surfaces;
  std::erase_if(solids_, [&](StructureIndex s) { return !is_solid(s); });
  for (const IndexPlane& plane : planes_) outlined_.push_back(outlined(slightly_inside(plane)));
}

std::vector<bool> ReferenceCut::outlined(const IndexPlane& plane) const {
  std::vector<bool> result(content_.graph.size());
  for (const StructureIndex s : solids_) {
    const SurfaceMesh& mesh = content_.surfaces[s];
    const auto is_removed = [&](const std::array<float, 3>& p) {
      return plane.distance({p[0], p[1], p[2]}) > 0;
    };
    // Every edge across the plane belongs to as many triangles in one direction as in the other
    std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
    for (const auto& corners : mesh.triangles) {
      for (std::size_t n = 0; n < 3; ++n) {
        const auto &a = mesh.positions_ijk[corners[n]], &b = mesh.positions_ijk[corners[(n + 1) % 3]];
        if (is_removed(a) == is_removed(b)) continue;
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
    result[s] = std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
  }
  return result;
}

bool ReferenceCut::hides(StructureIndex a, StructureIndex b) const {
  return std::tuple(selection_.structures[a].term, a) > std::tuple(selection_.structures[b].term, b);
}

std::optional<StructureIndex> ReferenceCut::solid_at(const Vec3& index, const IndexPlane& plane,
                                                     const std::vector<bool>& outlined) const {
  // The direction has no special angle to the axes
  const Vec3 direction = cross(plane.normal, Vec3{0.53771, 0.71333, 0.44917});
  std::optional<StructureIndex> best;
  for (const StructureIndex s : solids_) {
    if (!outlined[s] || (best && hides(*best, s))) continue;
    const SurfaceMesh& mesh = content_.surfaces[s];
    int winding = 0;
    for (const auto& corners : mesh.triangles) {
      const auto corner = [&](std::size_t n) {
        const auto& p = mesh.positions_ijk[corners[n]];
        return Vec3{p[0], p[1], p[2]};
      };
      // Moeller and Trumbore 1997
      const Vec3 origin = corner(0), p = minus(corner(1), origin), q = minus(corner(2), origin);
      const Vec3 across = cross(direction, q), from = minus(index, origin), beside = cross(from, p);
      const double volume = dot(p, across);
      if (volume == 0) continue;
      const double u = dot(from, across) / volume, v = dot(direction, beside) / volume;
      if (u < 0 || v < 0 || u + v > 1 || dot(q, beside) / volume <= 0) continue;
      winding += volume > 0 ? 1 : -1;
    }
    if (winding != 0) best = s;
  }
  return best;
}

KeptRay ReferenceCut::clip(const Ray& ray, double from_mm, double margin) const {
  KeptRay kept{from_mm, kInfinity};
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    const double start = planes_[n].distance(ray.start) + margin, per_mm = dot(planes_[n].normal, ray.per_mm);
    if (per_mm == 0 && start > 0) return {0, -kInfinity};
    if (per_mm == 0) continue;
    const double s = -start / per_mm;
    if (per_mm < 0 && s > kept.from_mm) {
      kept.from_mm = s;
      kept.front = n;
    }
    if (per_mm > 0 && s < kept.to_mm) {
      kept.to_mm = s;
      kept.back = n;
    }
  }
  return kept;
}

RayInterval ReferenceCut::surfaces(const Ray& ray, double from_mm) const {
  if (empty()) return {from_mm, kInfinity};
  const KeptRay kept = clip(ray, from_mm, 1.0 / 4096);
  return kept.empty() ? RayInterval{kInfinity, -kInfinity} : RayInterval{kept.from_mm, kept.to_mm};
}

ReferenceFace ReferenceCut::front(const Ray& ray, const KeptRay& kept) const {
  if (!kept.front || kept.empty() || caps_ == CapMode::kNone) return {};
  return face(ray.at(kept.from_mm), *kept.front);
}

ReferenceFace ReferenceCut::back(const Ray& ray, const KeptRay& kept) const {
  if (!kept.back || kept.empty() || caps_ == CapMode::kNone) return {};
  return face(ray.at(kept.to_mm), *kept.back);
}

std::optional<StructureIndex> ReferenceCut::structure_at(const Index3& voxel,
                                                         const std::vector<bool>& without) const {
  if (!grid_.contains(voxel[0], voxel[1], voxel[2])) return std::nullopt;
  const auto place = static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2]));
  std::optional<StructureIndex> best;
  for (const Membership& member : content_.classes.members(content_.class_volume[place])) {
    const StructureIndex s = member.structure;
    const StructureDraw& draw = selection_.structures[s];
    const bool is_hull = draw.ghost && draw.mode == DrawMode::kSurface;
    if (!member.holds() || draw.mode == DrawMode::kOff || is_hull || without[s]) continue;
    if (!best || hides(s, *best)) best = s;
  }
  if (!best) return best;
  return share_of_face(voxel, *best) > 0 ? best : std::nullopt;
}

double ReferenceCut::share_of_face(const Index3& voxel, StructureIndex s) const {
  if (is_solid(s)) return 1;
  const auto place = static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2]));
  const StructureDraw& draw = selection_.structures[s];
  for (const Membership& member : content_.classes.members(content_.class_volume[place])) {
    const StructureDraw& other = selection_.structures[member.structure];
    if (member.holds() && hides(member.structure, s) && other.mode == DrawMode::kBoth)
      return 1;  // its volume
  }
  const double grey = content_.values.empty() ? HUGE_VAL : value_of(content_.values, place);
  const double opacity = static_cast<double>(full_opacity(draw));
  if (opacity == 0) return 0;
  const double most = -std::log1p(-opacity) / voxel_side_mm(grid_);
  const TransferCurve curve = transfer_curve(draw, content_.display);
  return std::min(1.0, 8 * transfer(curve, grey, voxel_side_mm(grid_)).extinction_per_mm / most);
}

bool ReferenceCut::is_solid(StructureIndex s) const {
  const StructureDraw& draw = selection_.structures[s];
  return draw.mode != DrawMode::kVolume && !draw.ghost;
}

bool ReferenceCut::has_greys() const {
  const double width = content_.display.window_high - content_.display.window_low;
  return !content_.values.empty() && width > 0 && std::isfinite(width);
}

double ReferenceCut::grey_at(const Index3& voxel) const {
  if (!has_greys()) return 1;
  const Display& display = content_.display;
  const double width = display.window_high - display.window_low;
  const double grey =
      value_of(content_.values, static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2])));
  if (std::isnan(grey)) return 0;
  return std::clamp((grey - display.window_low) / width, -100.0, 100.0);
}

ReferenceFace ReferenceCut::face(const Vec3& index, std::size_t number) const {
  const IndexPlane plane = slightly_inside(planes_[number]);
  const std::vector<bool>& outlined = outlined_[number];
  const std::vector<bool> none(outlined.size());
  // Take the last of the solids that enclose the point and the volume with the largest share of it; ties go
  // to the nearest voxel, on the kept side
  Vec3 inside = index;
  Index3 nearest{};
  for (std::size_t a = 0; a < 3; ++a) {
    inside[a] -= kTie * plane.normal[a];
    nearest[a] = static_cast<std::int64_t>(std::floor(inside[a] + 0.5));
  }
  std::optional<StructureIndex> s = structure_at(nearest, outlined);
  std::map<std::optional<StructureIndex>, double> shares;
  double any = 0;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    const auto structure = structure_at(corner, outlined);
    if (!structure) return;
    shares[structure] += weight * share_of_face(corner, *structure);
    any += weight * share_of_face(corner, *structure);
  });
  if (any < 0.5 - kTie) s.reset();
  if (any > 0.5 + kTie || s) {
    for (const auto& [structure, share] : shares) {
      if (share > shares[s] + kTie) s = structure;
    }
  }
  const auto solid = solid_at(inside, plane, outlined);
  const bool is_enclosed = solid && (!s || hides(*solid, *s));
  if (is_enclosed) s = solid;
  if (!s) {
    bool all = true;
    for_each_corner(index, [&](const Index3& corner, double) {
      const auto own = structure_at(corner, outlined), shown = own ? own : structure_at(corner, none);
      all = all && shown && share_of_face(corner, *shown) >= 1;
    });
    if (all) s = structure_at(nearest, none);
  }
  if (!s) return {};

  double grey = 0, weights = 0;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    if (!structure_at(corner, none)) return;
    weights += weight;
    grey += weight * grey_at(corner);
  });
  if (weights == 0) return {};
  const StructureDraw& draw = selection_.structures[*s];
  const bool is_of_solid = is_solid(*s) || is_enclosed;  // external surfaces are always drawn
  const double opacity = static_cast<double>(is_of_solid ? draw.opacity.value_or(1.0f) : full_opacity(draw));
  const double luminance = linear_of_grey(grey / weights);
  std::array<double, 3> color = linear_of(draw.color);
  if (caps_ == CapMode::kValues) color.fill(luminance);
  if (caps_ == CapMode::kBoth && has_greys()) {
    // On the way from black over the colour to white, where the luminance is that of the grey value
    const double of_color = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
    for (double& channel : color) {
      channel = luminance < of_color
                    ? channel * luminance / of_color
                    : channel + (1 - channel) * (luminance - of_color) / (1 - of_color + 1e-300);
    }
  }
  ReferenceFace face;
  face.structure = *s;
  for (std::size_t c = 0; c < 3; ++c) face.rgba[c] = opacity * color[c];
  face.rgba[3] = opacity;
  return face;
}

}  // namespace splatlas::reference
