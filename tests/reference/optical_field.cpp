#include "tests/reference/optical_field.h"

#include <algorithm>

#include "format/content/decision_tree.h"
#include "player/transfer_function.h"
#include "tests/reference/voxel_light.h"

namespace splatlas::reference {
namespace {

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

VoxelOptics optics_of(const TransferValue& value, const std::array<double, 3>& color) {
  const double emission = value.extinction_per_mm * value.shade;
  return {value.extinction_per_mm, {emission * color[0], emission * color[1], emission * color[2]}};
}

RayRadiance slab(const VoxelOptics& optics, double length_mm) {
  if (optics.extinction <= 0) return {};
  const double absorbed = -std::expm1(-optics.extinction * length_mm);
  RayRadiance radiance{optics.emission, 1 - absorbed};
  for (double& color : radiance.color) color *= absorbed / optics.extinction;
  return radiance;
}

double value_of(const VoxelBuffer& values, std::size_t n) {
  return visit_voxel_type(values.type,
                          [&](auto tag) { return static_cast<double>(values.as<decltype(tag)>()[n]); });
}

double voxel_side_mm(const Grid& grid) {
  const Affine to_mm = index_to_lps_mm(grid);
  const Vec3 i = to_mm.apply_linear({1, 0, 0}), j = to_mm.apply_linear({0, 1, 0}),
             k = to_mm.apply_linear({0, 0, 1});
  return std::cbrt(std::abs(dot(cross(i, j), k)));
}

VoxelOptics OpticalField::at(std::int64_t i, std::int64_t j, std::int64_t k) const {
  if (!grid.contains(i, j, k)) return {};
  return voxels[static_cast<std::size_t>(grid.offset(i, j, k))];
}

VoxelOptics OpticalField::trilinear(const Vec3& index) const {
  VoxelOptics sum;
  for_each_corner(index, [&](const Index3& corner, double weight) {
    sum.add(weight, at(corner[0], corner[1], corner[2]));
  });
  return sum;
}

OpticalField optical_field(const AtlasContent& content, const Selection& selection, const ParallelView& view,
                           bool hybrid_shading, const std::optional<ShareChannels>& shares) {
  OpticalField field{storage_grid(content), {}};
  field.voxels.resize(content.class_volume.size());
  const double reference_length_mm = voxel_side_mm(field.grid);
  const DrawPlan plan = DecisionTree(content.graph, content.classes).plan(selection);
  std::vector<const ClassDraw*> draw_of(content.classes.size(), nullptr);
  for (const ClassDraw& draw : plan.classes) draw_of[draw.id] = &draw;

  std::vector<TransferCurve> curve_of;  // per structure
  for (const StructureDraw& appearance : selection.structures) {
    curve_of.push_back(transfer_curve(appearance, content.display));
  }

  std::vector<LitVoxel> lit;
  if (hybrid_shading && !shares) lit = lit_voxels(content, selection);
  double drawn = 0;  // voxels
  for (std::size_t n = 0; n < field.voxels.size(); ++n) {
    const ClassId c = content.class_volume[n];
    const ClassDraw* draw = draw_of[c];
    if (draw == nullptr || !draws_volume(draw->role)) continue;
    const StructureDraw& appearance = selection.structures[draw->volume_of];
    const TransferCurve& curve = curve_of[draw->volume_of];
    const double grey = content.values.empty() ? HUGE_VAL : value_of(content.values, n);
    TransferValue value = transfer(curve, grey, reference_length_mm);
    if (shares) {
      value.shade = 1;
    } else if (hybrid_shading) {
      const auto normal = unpack_normal(lit[n].normal);
      value.shade *= 1 + lit[n].lit * (diffuse(view, {normal[0], normal[1], normal[2]}) - 1);
    }
    field.mean_densest += (densest_of(curve, reference_length_mm) - field.mean_densest) / ++drawn;
    field.voxels[n] =
        optics_of(value, shares ? share_color(*shares, draw->volume_of) : linear_of(appearance.color));
  }
  return field;
}

}  // namespace splatlas::reference
