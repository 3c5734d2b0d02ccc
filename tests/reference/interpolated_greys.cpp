#include "tests/reference/interpolated_greys.h"

#include <algorithm>
#include <cmath>

#include "format/content/decision_tree.h"

namespace splatlas::reference {

InterpolatedGreys::InterpolatedGreys(const AtlasContent& content, const Selection& selection,
                                     const std::optional<ShareChannels>& shares)
    : values_(content.values),
      classified_before_(optical_field(content, selection, {}, false)),
      reference_length_mm_(voxel_side_mm(grid())),
      shares_(shares),
      structures_(content.class_volume.size(), kNoStructure) {
  for (const ClassDraw& draw : DecisionTree(content.graph, content.classes).plan(selection).classes) {
    if (!draws_volume(draw.role)) continue;
    const StructureDraw& structure = selection.structures[draw.volume_of];
    const TransferCurve curve = transfer_curve(structure, content.display);
    auto field =
        std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.curve == curve; });
    if (field == fields_.end()) {
      const TransferPoint& first = curve.points.front();
      const bool shows_zero = evaluate(curve, 0, 1).extinction_per_mm > 0;
      const bool classified_before = values_.empty() || (shows_zero && first.opacity > 0);
      field = fields_.insert(fields_.end(), Field{curve, classified_before, shows_zero ? first.grey : 0, {}});
      field->color.resize(content.class_volume.size());
    }
    for (std::size_t v = 0; v < field->color.size(); ++v) {
      if (content.class_volume[v] != draw.id) continue;
      field->color[v] = linear_of(structure.color);
      structures_[v] = draw.volume_of;
    }
  }
}

VoxelOptics InterpolatedGreys::at(const Field& field, const Vec3& index) const {
  double grey = 0, members = 0;
  std::array<double, 3> color{};
  VoxelOptics optics;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    const bool inside = grid().contains(corner[0], corner[1], corner[2]);
    const auto voxel = inside ? static_cast<std::size_t>(grid().offset(corner[0], corner[1], corner[2])) : 0;
    if (!inside || !field.color[voxel]) {
      grey += weight * field.outside;
      return;
    }
    if (!values_.empty()) {
      // Not-a-number counts as the first point, infinity as one width beyond the last.
      const double g = value_of(values_, voxel);
      const double first = field.curve.points.front().grey, last = field.curve.points.back().grey;
      const double infinite = g > 0 ? 2 * last - first : 2 * first - last;
      grey += weight * (std::isnan(g) ? first : std::isinf(g) ? infinite : g);
    }
    members += weight;
    for (std::size_t c = 0; c < 3; ++c) color[c] += weight * (*field.color[voxel])[c];
    optics.add(weight, classified_before_.voxels[voxel]);
  });
  if (field.classified_before || members == 0) return optics;
  for (double& channel : color) channel /= members;
  return optics_of(transfer(field.curve, grey, reference_length_mm_), color);
}

VoxelOptics InterpolatedGreys::shares_at(double extinction, const Vec3& index) const {
  VoxelOptics shares{extinction, {}};
  double members = 0;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    if (!grid().contains(corner[0], corner[1], corner[2])) return;
    const StructureIndex s =
        structures_[static_cast<std::size_t>(grid().offset(corner[0], corner[1], corner[2]))];
    if (s == kNoStructure) return;
    members += weight;
    const std::array<double, 3> color = share_color(*shares_, s);
    for (std::size_t c = 0; c < 3; ++c) shares.emission[c] += weight * extinction * color[c];
  });
  for (double& channel : shares.emission) channel /= std::max(members, 1e-300);
  return shares;
}

RayRadiance InterpolatedGreys::along(const Ray& ray, double from_mm, double to_mm, int steps) const {
  RayRadiance sum;
  const double step_mm = (to_mm - from_mm) / steps;
  for (int n = 0; n < steps; ++n) {
    VoxelOptics optics;
    const Vec3 index = ray.at(from_mm + (n + 0.5) * step_mm);
    for (const Field& field : fields_) optics.add(1, at(field, index));
    sum.add(slab(shares_ ? shares_at(optics.extinction, index) : optics, step_mm));
  }
  return sum;
}

}  // namespace splatlas::reference
