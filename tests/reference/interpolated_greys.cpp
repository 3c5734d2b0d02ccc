#include "tests/reference/interpolated_greys.h"

#include <algorithm>
#include <cmath>

#include "format/decision_tree.h"

namespace splatlas::reference {

InterpolatedGreys::InterpolatedGreys(const AtlasContent& content, const Selection& selection)
    : grid_(storage_grid(content)),
      values_(content.values),
      reference_length_mm_(std::cbrt(grid_.spacing_mm[0] * grid_.spacing_mm[1] * grid_.spacing_mm[2])) {
  const std::size_t voxels = content.class_volume.size();
  for (const ClassDraw& draw : DecisionTree(content.graph, content.classes).plan(selection).classes) {
    if (draw.role != VoxelRole::kVolume && draw.role != VoxelRole::kHybrid) continue;
    const StructureDraw& structure = selection.structures[draw.volume_of];
    const TransferCurve curve = transfer_curve(structure, content.display);
    auto field =
        std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.curve == curve; });
    if (field == fields_.end()) {
      const bool shows_zero = evaluate(curve, 0, 1).extinction_per_mm > 0;
      Field made{curve, false, 0, std::vector<bool>(voxels), {}};
      made.outside = shows_zero ? curve.points.front().grey : 0;
      made.classified_before = values_.empty() || (shows_zero && curve.points.front().opacity > 0);
      made.color.resize(voxels);
      made.optics.resize(voxels);
      field = fields_.insert(fields_.end(), std::move(made));
    }
    for (std::size_t v = 0; v < voxels; ++v) {
      if (content.class_volume[v] != draw.id) continue;
      field->drawn[v] = true;
      field->color[v] = linear_of(structure.color);
      const double g = values_.empty() ? curve.points.back().grey : grey(v);
      const TransferValue value = transfer(curve, g, reference_length_mm_);
      field->optics[v] = {value.extinction_per_mm, 0, 0, 0};
      for (std::size_t c = 0; c < 3; ++c) {
        field->optics[v][c + 1] = value.extinction_per_mm * value.shade * field->color[v][c];
      }
    }
  }
}

double InterpolatedGreys::grey(std::size_t voxel) const {
  return visit_voxel_type(values_.type,
                          [&](auto tag) { return static_cast<double>(values_.as<decltype(tag)>()[voxel]); });
}

std::array<double, 4> InterpolatedGreys::at(const Field& field, const Vec3& index) const {
  double grey_sum = 0, members = 0;
  std::array<double, 3> color{};
  std::array<double, 4> optics{};
  for (int n = 0; n < 8; ++n) {
    double weight = 1;
    Index3 corner{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = std::floor(index[a]);
      const bool high = (n >> a & 1) != 0;
      weight *= high ? index[a] - low : 1 - (index[a] - low);
      corner[a] = static_cast<std::int64_t>(low) + (high ? 1 : 0);
    }
    const bool inside = grid_.contains(corner[0], corner[1], corner[2]);
    const auto voxel = inside ? static_cast<std::size_t>(grid_.offset(corner[0], corner[1], corner[2])) : 0;
    if (!inside || !field.drawn[voxel]) {
      grey_sum += weight * field.outside;
      continue;
    }
    if (!values_.empty()) {
      // Not-a-number counts as the first point, infinity as one width beyond the last.
      const double g = grey(voxel);
      const double first = field.curve.points.front().grey, last = field.curve.points.back().grey;
      const double infinite = g > 0 ? 2 * last - first : 2 * first - last;
      grey_sum += weight * (std::isnan(g) ? first : std::isinf(g) ? infinite : g);
    }
    members += weight;
    for (std::size_t c = 0; c < 3; ++c) color[c] += weight * field.color[voxel][c];
    for (std::size_t c = 0; c < 4; ++c) optics[c] += weight * field.optics[voxel][c];
  }
  if (field.classified_before || members == 0) return optics;
  const TransferValue value = transfer(field.curve, grey_sum, reference_length_mm_);
  optics[0] = value.extinction_per_mm;
  for (std::size_t c = 0; c < 3; ++c) optics[c + 1] = optics[0] * value.shade * color[c] / members;
  return optics;
}

RayRadiance InterpolatedGreys::along(const Ray& ray, double from_mm, double to_mm, int steps) const {
  RayRadiance sum;
  const double step_mm = (to_mm - from_mm) / steps;
  for (int n = 0; n < steps; ++n) {
    std::array<double, 4> optics{};
    const Vec3 index = ray.at(from_mm + (n + 0.5) * step_mm);
    for (const Field& field : fields_) {
      const std::array<double, 4> more = at(field, index);
      for (std::size_t c = 0; c < 4; ++c) optics[c] += more[c];
    }
    if (optics[0] <= 0) continue;
    const double absorbed = -std::expm1(-optics[0] * step_mm);
    RayRadiance slab{{optics[1], optics[2], optics[3]}, 1 - absorbed};
    for (double& color : slab.color) color *= absorbed / optics[0];
    sum.add(slab);
  }
  return sum;
}

}  // namespace splatlas::reference
