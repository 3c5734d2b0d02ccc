#include "player/render/light/voxel_light.h"

#include <cmath>

namespace splatlas {

VoxelLighter::VoxelLighter(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid, bool shade)
    : label_normals_(cache.normals()), shade_(shade), scan_first_(runs.box().first[0]) {
  const ScanOrder scan = ScanOrder::of(runs.axis());
  const std::array<std::uint8_t, 3> axes{scan.scan_axis, scan.row_axis, scan.slice_axis};
  const std::array<std::int64_t, 3> step{1, grid.size[0], grid.size[0] * grid.size[1]};
  const Affine to_index = lps_mm_to_index(grid);
  GradientScale scale;
  for (std::size_t a = 0; a < 3; ++a) {
    step_[a] = static_cast<std::size_t>(step[axes[a]]);
    for (std::size_t b = 0; b < 3; ++b)
      scale.to_lps[a][b] = static_cast<float>(to_index.linear[std::size_t{3} * axes[a] + b]);
    const double mm = grid.spacing_mm[axes[a]];
    scale.per_mm_squared[a] = static_cast<float>(1 / (mm * mm));
  }
  if (!shade || cache.values() == nullptr || runs.count() == 0) return;
  constexpr double kReach = 3;  // voxels
  scale.reach_mm = static_cast<float>(kReach * std::cbrt(1 / std::abs(determinant(to_index.linear))));
  grey_.emplace(runs, cache, grid, scale);
  const std::size_t voxels = static_cast<std::size_t>(runs.scan_voxels()) + kLightPadding;
  labels_.resize(voxels);
  normals_.resize(voxels);
  lit_.resize(voxels);
  below_.resize(voxels);
  above_.resize(voxels);
}

void VoxelLighter::find_extinctions(const TransferTable& transfer, const float* greys,
                                    const GradientRow& gradients, std::size_t count) {
  if (const TransferTable::View table = transfer.view(); !table.shares.empty())
    return light_kernels().extinctions(table, greys, gradients.reach, count, below_.data(), above_.data());
  for (std::size_t n = 0; n < count; ++n) {
    const auto at = [&](float grey) { return transfer.share_of(static_cast<double>(grey)).extinction; };
    below_[n] = at(greys[n] - gradients.reach[n]);
    above_[n] = at(greys[n] + gradients.reach[n]);
  }
}

VoxelLight VoxelLighter::light(const VolumeAppearance& appearance, bool boundary, std::int64_t slice,
                               std::int64_t row, std::uint32_t first, std::uint32_t count) {
  if (!shade_ || (!boundary && !grey_)) return {};
  const std::size_t voxel = static_cast<std::size_t>(slice) * step_[2] +
                            static_cast<std::size_t>(row) * step_[1] + first * step_[0];
  if (!grey_) return {label_normals_ + voxel, step_[0], nullptr};
  if (slice != slice_ || row != row_) grey_->set_row(slice, row);
  slice_ = slice;
  row_ = row;
  const auto begin = static_cast<std::size_t>(first - scan_first_);
  const GradientRow gradients = grey_->at(first);
  const LitRow lit{&normals_[begin], &lit_[begin]};
  if (boundary) {
    for (std::size_t n = 0; n < count; ++n) labels_[n] = label_normals_[voxel + n * step_[0]];
    light_kernels().boundary(labels_.data(), count, gradients, lit);
  } else {
    find_extinctions(*appearance.transfer, grey_->greys(first), gradients, count);
    light_kernels().interior(below_.data(), above_.data(), count, gradients, lit);
  }
  return {lit.normals, 1, lit.lit};
}

}  // namespace splatlas
