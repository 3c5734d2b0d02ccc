#include "player/render/light/voxel_light.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "format/content/voxel_type.h"

namespace splatlas {

GreyGradient::GreyGradient(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid,
                           const GradientScale& scale)
    : runs_(runs),
      cache_(cache),
      scale_(scale),
      scan_first_(runs.box().first[0]),
      row_first_(runs.box().first[1]),
      width_(runs.scan_voxels() + 2),
      height_(runs.rows() + 2) {
  const ScanOrder scan = ScanOrder::of(runs.axis());
  const std::array<std::int64_t, 3> step{1, grid.size[0], grid.size[0] * grid.size[1]};
  const std::array<std::uint8_t, 3> axes{scan.scan_axis, scan.row_axis, scan.slice_axis};
  for (std::size_t a = 0; a < 3; ++a) step_[a] = static_cast<std::size_t>(step[axes[a]]);
  const std::size_t floats = static_cast<std::size_t>(width_) + kLightPadding;
  for (std::vector<float>& row : sums_) row.resize(floats);
  for (std::vector<float>& row : direction_) row.resize(floats);
  coherence_.resize(floats);
  reach_.resize(floats);
}

void GreyGradient::fill(std::int64_t slice, Plane& plane) const {
  // Clear the slice before
  for (std::size_t row = 0; row + 1 < plane.first_segment.size(); ++row) {
    for (std::size_t n = plane.first_segment[row]; n < plane.first_segment[row + 1]; ++n) {
      const auto [begin, end] = plane.segments[n];
      for (std::vector<float>* floats : {&plane.values, &plane.selected})
        std::fill_n(floats->data() + static_cast<std::int64_t>(row) * width_ + begin, end - begin, 0.0f);
    }
  }
  plane.slice = slice;
  plane.segments.clear();
  plane.first_segment.assign(1, 0);
  plane.values.resize(static_cast<std::size_t>(width_ * height_) + 2 * kLightPadding);
  plane.selected.resize(plane.values.size());

  constexpr std::int64_t kSmallGap = 16;
  const auto begin_row = [&](std::int64_t row) {
    plane.first_segment.resize(static_cast<std::size_t>(row) + 1, plane.segments.size());
  };
  visit_voxel_type(cache_.value_type(), [&](auto tag) {
    using T = decltype(tag);
    runs_.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
      const std::int64_t row = run.row - row_first_ + 1, begin = run.start - scan_first_ + 1;
      begin_row(row);
      if (plane.first_segment.back() == plane.segments.size() ||
          begin > plane.segments.back().end + kSmallGap)
        plane.segments.push_back({begin, begin});
      plane.segments.back().end = begin + run.length;
      float* const values = plane.values.data() + row * width_ + begin;
      float* const selected = plane.selected.data() + row * width_ + begin;
      const std::byte* from = cache_.values() + sizeof(T) * (static_cast<std::size_t>(slice) * step_[2] +
                                                             run.row * step_[1] + run.start * step_[0]);
      for (std::size_t n = 0; n < run.length; ++n) {
        T value;
        std::memcpy(&value, from + n * step_[0] * sizeof(T), sizeof(T));
        const auto grey = static_cast<float>(value);
        const bool finite = std::isfinite(grey);
        values[n] = finite ? grey : 0;
        selected[n] = finite ? 1 : 0;
      }
    });
  });
  begin_row(height_);
}

void GreyGradient::set_slice(std::int64_t slice) {
  std::array<Plane, 3> before = std::exchange(planes_, {});
  for (std::int64_t n = 0; n < 3; ++n) {
    const auto known = std::ranges::find(before, slice + n - 1, &Plane::slice);
    if (known != before.end()) planes_[static_cast<std::size_t>(n)] = std::exchange(*known, {});
  }
  for (std::int64_t n = 0; n < 3; ++n) {
    Plane& plane = planes_[static_cast<std::size_t>(n)];
    if (plane.slice == slice + n - 1) continue;
    const auto free = std::ranges::find_if(before, [](const Plane& p) { return !p.values.empty(); });
    if (free != before.end()) plane = std::exchange(*free, {});
    fill(slice + n - 1, plane);
  }
}

void GreyGradient::set_row(std::int64_t slice, std::int64_t row) {
  if (planes_[1].slice != slice) set_slice(slice);
  row_ = row - row_first_ + 1;
  const std::vector<std::size_t>& first = planes_[1].first_segment;
  for (std::size_t n = first[static_cast<std::size_t>(row_)]; n < first[static_cast<std::size_t>(row_) + 1];
       ++n)
    measure(planes_[1].segments[n]);
}

void GreyGradient::measure(const Segment& segment) {
  GreyRows rows;
  for (std::size_t k = 0; k < 9; ++k) {
    const Plane& plane = planes_[k / 3];
    const std::int64_t place = (row_ + static_cast<std::int64_t>(k % 3) - 1) * width_ + segment.begin;
    rows.values[k] = plane.values.data() + place;
    rows.selected[k] = plane.selected.data() + place;
  }
  std::array<PairSums, 3> sums;
  for (std::size_t a = 0; a < 3; ++a)
    sums[a] = {sums_[3 * a].data(), sums_[3 * a + 1].data(), sums_[3 * a + 2].data()};
  kernels_.gradient(rows, static_cast<std::size_t>(segment.end - segment.begin), scale_, sums,
                    row_from(segment.begin - 1));
}

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
    return kernels_.extinctions(table, greys, gradients.reach, count, below_.data(), above_.data());
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
    kernels_.boundary(labels_.data(), count, gradients, lit);
  } else {
    find_extinctions(*appearance.transfer, grey_->greys(first), gradients, count);
    kernels_.interior(below_.data(), above_.data(), count, gradients, lit);
  }
  return {lit.normals, 1, lit.lit};
}

}  // namespace splatlas
