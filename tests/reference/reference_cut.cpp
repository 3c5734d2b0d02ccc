#include "tests/reference/reference_cut.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "player/transfer_function.h"
#include "tests/reference/optical_field.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double linear_of_grey(double encoded) {
  const double e = std::clamp(encoded, 0.0, 1.0);
  return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
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
  return face(ray.at(kept.from_mm), planes_[*kept.front]);
}

ReferenceFace ReferenceCut::back(const Ray& ray, const KeptRay& kept) const {
  if (!kept.back || kept.empty() || caps_ == CapMode::kNone) return {};
  return face(ray.at(kept.to_mm), planes_[*kept.back]);
}

std::optional<StructureIndex> ReferenceCut::structure_at(const Index3& voxel) const {
  if (!grid_.contains(voxel[0], voxel[1], voxel[2])) return std::nullopt;
  const auto place = static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2]));
  std::optional<StructureIndex> best;
  const auto rank = [&](StructureIndex s) { return std::tuple(selection_.structures[s].term, s); };
  for (const Membership& member : content_.classes.members(content_.class_volume[place])) {
    const StructureIndex s = member.structure;
    if (!member.holds() || selection_.structures[s].mode == DrawMode::kOff) continue;
    if (!best || rank(s) > rank(*best)) best = s;
  }
  if (!best || selection_.structures[*best].mode != DrawMode::kVolume) return best;
  const double grey = content_.values.empty() ? HUGE_VAL : value_of(content_.values, place);
  const TransferCurve curve = transfer_curve(selection_.structures[*best], content_.display);
  return transfer(curve, grey, voxel_side_mm(grid_)).extinction_per_mm > 0 ? best : std::nullopt;
}

double ReferenceCut::grey_at(const Index3& voxel) const {
  const Display& display = content_.display;
  const double width = display.window_high - display.window_low;
  if (content_.values.empty() || !(width > 0) || !std::isfinite(width)) return 1;
  const double grey =
      value_of(content_.values, static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2])));
  if (std::isnan(grey)) return 0;
  return std::clamp((grey - display.window_low) / width, -100.0, 100.0);
}

ReferenceFace ReferenceCut::face(const Vec3& index, const IndexPlane& plane) const {
  // Find the nearest voxel; ties go to the kept side
  Index3 nearest{};
  for (std::size_t a = 0; a < 3; ++a)
    nearest[a] = static_cast<std::int64_t>(std::floor(index[a] - 1e-6 * plane.normal[a] + 0.5));
  const std::optional<StructureIndex> s = structure_at(nearest);
  if (!s) return {};

  double grey = 0, weights = 0;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    if (!structure_at(corner)) return;
    weights += weight;
    grey += weight * grey_at(corner);
  });
  const StructureDraw& draw = selection_.structures[*s];
  const double opacity = draw.mode == DrawMode::kVolume ? static_cast<double>(full_opacity(draw))
                                                        : static_cast<double>(draw.opacity.value_or(1.0f));
  const double intensity = caps_ == CapMode::kLabels ? 1 : linear_of_grey(grey / weights);
  const std::array<double, 3> color =
      caps_ == CapMode::kValues ? std::array<double, 3>{1, 1, 1} : linear_of(draw.color);
  ReferenceFace face;
  face.structure = *s;
  for (std::size_t c = 0; c < 3; ++c) face.rgba[c] = opacity * intensity * color[c];
  face.rgba[3] = opacity;
  return face;
}

}  // namespace splatlas::reference
