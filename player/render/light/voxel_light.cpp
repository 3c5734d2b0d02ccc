#include "player/render/light/voxel_light.h"

#include <algorithm>
#include <cmath>

#include "player/render/decode/span_blocks.h"

namespace splatlas {
namespace {

/// 0 up to `low`, 1 from `high` on, linear between them.
float ramp(float x, float low, float high) {
  return std::clamp((x - low) / (high - low), 0.0f, 1.0f);
}

}  // namespace

VoxelLighter::VoxelLighter(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid, bool shade)
    : label_normals_(cache.normals()), shade_(shade), scan_first_(runs.box().first[0]) {
  const ScanOrder scan = ScanOrder::of(runs.axis());
  const std::array<std::uint8_t, 3> axes{scan.scan_axis, scan.row_axis, scan.slice_axis};
  const std::array<std::int64_t, 3> step{1, grid.size[0], grid.size[0] * grid.size[1]};
  const Affine to_index = lps_mm_to_index(grid);
  for (std::size_t a = 0; a < 3; ++a) {
    step_[a] = static_cast<std::size_t>(step[axes[a]]);
    for (std::size_t b = 0; b < 3; ++b) to_lps_[a][b] = static_cast<float>(to_index.linear[3u * axes[a] + b]);
  }
  if (!shade || cache.values() == nullptr || runs.count() == 0) return;
  constexpr double kReach = 1.5;  // voxels
  reach_mm_ = static_cast<float>(kReach * std::cbrt(1 / std::abs(determinant(to_index.linear))));
  grey_.emplace(runs, cache, grid);
  normals_.resize(static_cast<std::size_t>(runs.scan_voxels()));
  lit_.resize(normals_.size());
}

std::array<float, 3> VoxelLighter::gradient_lps(std::int64_t scan) const {
  const std::array<float, 3> gradient = grey_->gradient(scan);
  std::array<float, 3> lps{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) lps[b] += gradient[a] * to_lps_[a][b];
  }
  return lps;
}

/// Where grey values change across the label's border, they tell its direction more finely.
void VoxelLighter::light_boundary(std::int64_t scan, float coherence, std::size_t n) {
  constexpr float kAcross = 0.3f, kAlong = 0.8f;
  const std::array<float, 3> grey = gradient_lps(scan), label = unpack_normal(normals_[n]);
  const float length = std::sqrt(grey[0] * grey[0] + grey[1] * grey[1] + grey[2] * grey[2]);
  const float cosine = (grey[0] * label[0] + grey[1] * label[1] + grey[2] * label[2]) / length;
  const float share = coherence * ramp(std::abs(cosine), kAcross, kAlong);
  if (!(share > 0)) return;
  const float of_grey = std::copysign(share, cosine) / length, of_label = 1 - share;
  normals_[n] = pack_normal({of_grey * grey[0] + of_label * label[0], of_grey * grey[1] + of_label * label[1],
                             of_grey * grey[2] + of_label * label[2]});
}

/// Inside, grey values define what is seen where the extinction changes with them.
void VoxelLighter::light_interior(const TransferTable& transfer, std::int64_t scan, float coherence,
                                  std::size_t n) {
  constexpr float kFlat = 0.05f, kSteep = 0.25f;
  const float grey = grey_->grey(scan), reach = reach_mm_ * std::sqrt(grey_->length_squared(scan));
  const float below = transfer.extinction_near(grey - reach), above = transfer.extinction_near(grey + reach);
  const float densest = std::max(below, above);
  if (!(densest > 0)) return;
  const float lit = coherence * ramp(std::abs(above - below) / densest, kFlat, kSteep);
  lit_[n] = static_cast<std::uint16_t>(lit * float{ShadedVoxel::kAllLit} + 0.5f);
  if (lit_[n] == 0) return;
  const std::array<float, 3> lps = gradient_lps(scan);
  const float sign = above > below ? -1.0f : 1.0f;  // towards lower extinctions
  normals_[n] = pack_normal({sign * lps[0], sign * lps[1], sign * lps[2]});
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
  constexpr float kNoise = 0.3f, kRamp = 0.6f;
  const auto begin = static_cast<std::size_t>(first - scan_first_);
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::int64_t scan = first + n;
    const std::size_t at = begin + n;
    const float coherence = ramp(grey_->length_squared(scan) / grey_->mean_square(scan), kNoise, kRamp);
    lit_[at] = boundary ? ShadedVoxel::kAllLit : std::uint16_t{0};
    if (boundary) normals_[at] = label_normals_[voxel + n * step_[0]];
    if (!(coherence > 0)) continue;
    if (boundary) {
      light_boundary(scan, coherence, at);
    } else {
      light_interior(*appearance.transfer, scan, coherence, at);
    }
  }
  return {&normals_[begin], 1, &lit_[begin]};
}

}  // namespace splatlas
