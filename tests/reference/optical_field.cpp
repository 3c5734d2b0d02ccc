#include "tests/reference/optical_field.h"

#include <algorithm>
#include <cmath>

#include "format/decision_tree.h"
#include "player/transfer_function.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {
namespace {

double value_of(const VoxelBuffer& values, std::size_t n) {
  return visit_voxel_type(values.type, [&](auto tag) {
    using T = decltype(tag);
    return static_cast<double>(values.as<T>()[n]);
  });
}

double densest_of(const TransferCurve& curve, double reference_length_mm) {
  double densest = 0;
  for (const TransferPoint& point : curve.points)
    densest = std::max(densest, extinction_of(point.opacity, reference_length_mm));
  return densest;
}

}  // namespace

void VoxelOptics::add(double weight, const VoxelOptics& other) {
  extinction += weight * other.extinction;
  for (std::size_t c = 0; c < 3; ++c) emission[c] += weight * other.emission[c];
}

VoxelOptics OpticalField::at(std::int64_t i, std::int64_t j, std::int64_t k) const {
  if (!grid.contains(i, j, k)) return {};
  return voxels[static_cast<std::size_t>(grid.offset(i, j, k))];
}

VoxelOptics OpticalField::trilinear(const Vec3& index) const {
  std::array<std::int64_t, 3> low{};
  Vec3 part{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = static_cast<std::int64_t>(std::floor(index[a]));
    part[a] = index[a] - std::floor(index[a]);
  }
  VoxelOptics sum;
  for (const int x : {0, 1}) {
    for (const int y : {0, 1}) {
      for (const int z : {0, 1}) {
        const double weight = (x == 1 ? part[0] : 1 - part[0]) * (y == 1 ? part[1] : 1 - part[1]) *
                              (z == 1 ? part[2] : 1 - part[2]);
        sum.add(weight, at(low[0] + x, low[1] + y, low[2] + z));
      }
    }
  }
  return sum;
}

OpticalField optical_field(const AtlasContent& content, const Selection& selection, const ParallelView& view,
                           bool hybrid_shading) {
  OpticalField field{storage_grid(content), {}};
  field.voxels.resize(content.class_volume.size());
  const Vec3& spacing = field.grid.spacing_mm;
  const double reference_length_mm = std::cbrt(spacing[0] * spacing[1] * spacing[2]);
  const DrawPlan plan = DecisionTree(content.graph, content.classes).plan(selection);
  std::vector<const ClassDraw*> draw_of(content.classes.size(), nullptr);
  for (const ClassDraw& draw : plan.classes) draw_of[draw.id] = &draw;

  std::vector<TransferCurve> curve_of;  // per structure
  for (const StructureDraw& appearance : selection.structures) {
    curve_of.push_back(transfer_curve(appearance, content.display));
  }

  double drawn = 0;                                         // voxels
  std::vector<std::size_t> met(content.classes.size(), 0);  // voxels per class so far
  for (std::size_t n = 0; n < field.voxels.size(); ++n) {
    const ClassId c = content.class_volume[n];
    const std::size_t number_in_class = met[c]++;
    const ClassDraw* draw = draw_of[c];
    if (draw == nullptr || (draw->role != VoxelRole::kVolume && draw->role != VoxelRole::kHybrid)) continue;
    const StructureDraw& appearance = selection.structures[draw->volume_of];
    const TransferCurve& curve = curve_of[draw->volume_of];
    const double grey = content.values.empty() ? HUGE_VAL : value_of(content.values, n);
    const TransferValue value = transfer(curve, grey, reference_length_mm);
    double shade = value.shade;
    if (hybrid_shading && draw->boundary) {
      const auto normal = unpack_normal(content.boundary_normals[c][number_in_class]);
      shade *= diffuse(view, {normal[0], normal[1], normal[2]});
    }
    field.mean_densest += (densest_of(curve, reference_length_mm) - field.mean_densest) / ++drawn;
    VoxelOptics& optics = field.voxels[n];
    optics.extinction = value.extinction_per_mm;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      optics.emission[channel] = optics.extinction * shade * linear_of(appearance.color)[channel];
    }
  }
  return field;
}

}  // namespace splatlas::reference
