#include "player/render/light/voxel_light.h"

#include <algorithm>
#include <cmath>

#include "player/render/decode/span_blocks.h"
#include "player/render/transfer/shading.h"

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
    for (std::size_t b = 0; b < 3; ++b)
      to_lps_[a][b] = static_cast<float>(to_index.linear[std::size_t{3} * axes[a] + b]);
  }
  if (!shade || cache.values() == nullptr || runs.count() == 0) return;
  constexpr double kReach = 3;  // voxels
  reach_mm_ = static_cast<float>(kReach * std::cbrt(1 / std::abs(determinant(to_index.linear))));
  grey_.emplace(runs, cache, grid);
  normals_.resize(static_cast<std::size_t>(runs.scan_voxels()));
  lit_.resize(normals_.size());
}

/// Loops over a block without branches become vector instructions.
struct VoxelLighter::Block {
  static constexpr std::size_t kSize = 64;
  using Lanes = std::array<float, kSize>;
  std::size_t count = 0;
  std::array<Lanes, 3> direction;  // of the gradient, then of the normal; of any length
  Lanes coherence, reach, lit;
  const float* greys = nullptr;
};

void VoxelLighter::load(std::int64_t first, std::size_t count, Block& block) const {
  constexpr float kNoise = 0.3f, kRamp = 0.6f;
  const float* const along = grey_->gradient(0, first);
  const float* const across = grey_->gradient(1, first);
  const float* const through = grey_->gradient(2, first);
  const float* const lengths = grey_->lengths_squared(first);
  const float* const squares = grey_->mean_squares(first);
  block.count = count;
  block.greys = grey_->greys(first);
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t b = 0; b < 3; ++b)
      block.direction[b][n] =
          along[n] * to_lps_[0][b] + across[n] * to_lps_[1][b] + through[n] * to_lps_[2][b];
  }
  for (std::size_t n = 0; n < count; ++n) {
    block.coherence[n] = ramp(lengths[n] / std::max(squares[n], 1e-30f), kNoise, kRamp);
    block.reach[n] = reach_mm_ * std::sqrt(lengths[n]);
  }
}

/// Replaces the label's normal by the gradient of the grey values as far as both have one direction.
void VoxelLighter::light_boundary(const PackedNormal* labels, std::size_t stride, Block& block) {
  constexpr float kAcross = 0.3f, kAlong = 0.8f;
  const UnpackedNormals& unpacked = unpacked_normals();
  for (std::size_t n = 0; n < block.count; ++n) {
    const PackedNormal packed = labels[n * stride];
    const std::array<float, 3> label{unpacked.x[packed], unpacked.y[packed], unpacked.z[packed]};
    const float x = block.direction[0][n], y = block.direction[1][n], z = block.direction[2][n];
    const float per_length = 1 / std::sqrt(std::max(x * x + y * y + z * z, 1e-30f));
    const float cosine = (x * label[0] + y * label[1] + z * label[2]) * per_length;
    const float share = block.coherence[n] * ramp(std::abs(cosine), kAcross, kAlong);
    const float of_grey = (cosine < 0 ? -share : share) * per_length;
    const bool agree = share > 0;  // false for overflows
    for (std::size_t a = 0; a < 3; ++a) {
      float& component = block.direction[a][n];
      component = agree ? of_grey * component + (1 - share) * label[a] : label[a];
    }
    block.lit[n] = 1;
  }
}

/// Inside, grey values define what is seen where the extinction changes with them.
void VoxelLighter::light_interior(const TransferTable& transfer, Block& block) {
  constexpr float kFlat = 0.01f, kSteep = 0.05f;
  for (std::size_t n = 0; n < block.count; ++n) {
    block.lit[n] = 0;
    if (!(block.coherence[n] > 0)) continue;
    const float below = transfer.extinction_near(block.greys[n] - block.reach[n]);
    const float above = transfer.extinction_near(block.greys[n] + block.reach[n]);
    const float densest = std::max(below, above);
    if (!(densest > 0)) continue;
    block.lit[n] = block.coherence[n] * ramp(std::abs(above - below) / densest, kFlat, kSteep);
    const float sign = above > below ? -1.0f : 1.0f;  // towards lower extinctions
    for (Block::Lanes& component : block.direction) component[n] *= sign;
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
  Block block;
  for (std::size_t done = 0; done < count; done += Block::kSize) {
    load(first + static_cast<std::int64_t>(done), std::min<std::size_t>(Block::kSize, count - done), block);
    if (boundary) {
      light_boundary(label_normals_ + voxel + done * step_[0], step_[0], block);
    } else {
      light_interior(*appearance.transfer, block);
    }
    const std::size_t at = begin + done;
    pack_normals_roughly(block.count, block.direction[0].data(), block.direction[1].data(),
                         block.direction[2].data(), &normals_[at]);
    for (std::size_t n = 0; n < block.count; ++n)
      lit_[at + n] = static_cast<std::uint16_t>(block.lit[n] * float{ShadedVoxel::kAllLit} + 0.5f);
  }
  return {&normals_[begin], 1, &lit_[begin]};
}

}  // namespace splatlas
