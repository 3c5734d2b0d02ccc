#include "tests/reference/masked_volume.h"

#include <algorithm>

#include "format/content/decision_tree.h"
#include "player/transfer_function.h"
#include "tests/reference/reference_radiance.h"
#include "tests/reference/voxel_light.h"

namespace splatlas::reference {

Result<MaskedVolume> masked_volume(const AtlasContent& content, const Selection& selection) {
  if (content.values.type != VoxelType::kUInt8) {
    return fail(ErrorCode::kFailed, "a masked copy needs an atlas with grey values of 8 bits without sign");
  }
  std::vector<bool> drawn(content.classes.size(), false);
  for (const ClassDraw& draw : DecisionTree(content.graph, content.classes).plan(selection).classes)
    drawn[draw.id] = draws_volume(draw.role);
  MaskedVolume volume{storage_grid(content), std::vector<std::uint8_t>(content.class_volume.size(), 0)};
  const auto greys = content.values.as<std::uint8_t>();
  for (std::size_t n = 0; n < volume.greys.size(); ++n) {
    if (drawn[content.class_volume[n]]) volume.greys[n] = greys[n];
  }
  if (content.boundary_normals.empty()) return volume;
  volume.normals.assign(volume.greys.size(), MaskedVolume::kOutside);
  volume.lit.assign(volume.greys.size(), 0);
  const std::vector<LitVoxel> lit = lit_voxels(content, selection);
  for (std::size_t n = 0; n < volume.normals.size(); ++n) {
    if (!drawn[content.class_volume[n]]) continue;
    volume.normals[n] = lit[n].lit > 0 ? std::int32_t{lit[n].normal} : MaskedVolume::kUnlit;
    volume.lit[n] = lit[n].lit;
  }
  return volume;
}

GreyAppearance::Knot GreyAppearance::at(double grey) const {
  const auto above = std::upper_bound(knots.begin(), knots.end(), grey,
                                      [](double g, const Knot& knot) { return g < knot.grey; });
  if (above == knots.begin()) return knots.front();
  if (above == knots.end()) return knots.back();
  const Knot& below = *(above - 1);
  const double part = (grey - below.grey) / (above->grey - below.grey);
  Knot knot{grey, below.extinction_per_mm + part * (above->extinction_per_mm - below.extinction_per_mm), {}};
  for (std::size_t c = 0; c < 3; ++c) {
    knot.color[c] = below.color[c] + part * (above->color[c] - below.color[c]);
  }
  return knot;
}

Result<GreyAppearance> grey_appearance(const StructureDraw& draw, const Display& display,
                                       double reference_length_mm) {
  const std::array<double, 3> color = linear_of(draw.color);
  GreyAppearance appearance;
  for (const TransferPoint& point : transfer_curve(draw, display).points) {
    const double shade = point.shade;
    appearance.knots.push_back({point.grey,
                                extinction_of(point.opacity, reference_length_mm),
                                {shade * color[0], shade * color[1], shade * color[2]}});
  }
  if (appearance.at(0).extinction_per_mm > 0) {
    return fail(ErrorCode::kFailed,
                "the transfer function shows a grey value of 0, which stands for nothing in a masked copy");
  }
  return appearance;
}

}  // namespace splatlas::reference
