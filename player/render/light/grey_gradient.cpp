#include "player/render/light/grey_gradient.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "format/content/voxel_type.h"

namespace splatlas {

GreyGradient::GreyGradient(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid)
    : runs_(runs),
      cache_(cache),
      scan_first_(runs.box().first[0]),
      row_first_(runs.box().first[1]),
      width_(runs.scan_voxels() + 2),
      height_(runs.rows() + 2) {
  const ScanOrder scan = ScanOrder::of(runs.axis());
  const std::array<std::int64_t, 3> step{1, grid.size[0], grid.size[0] * grid.size[1]};
  const std::array<std::uint8_t, 3> axes{scan.scan_axis, scan.row_axis, scan.slice_axis};
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t a = 0; a < 3; ++a) {
    step_[a] = static_cast<std::size_t>(step[axes[a]]);
    const double mm = grid.spacing_mm[axes[a]];
    per_mm_squared_[a] = static_cast<float>(1 / (mm * mm));
    means_[a].resize(width);
  }
  for (std::vector<float>* row : {&sums_.differences, &sums_.squares, &sums_.pairs, &lengths_, &squares_})
    row->resize(width);
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
  plane.values.resize(static_cast<std::size_t>(width_ * height_));
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

/// Adds the pairs of voxels of two rows, the second voxel `ahead` positions further.
void GreyGradient::add_pairs(const Plane& low, const Plane& high, std::int64_t low_row, std::int64_t high_row,
                             std::int64_t ahead, float weight) {
  const float* const low_values = low.values.data() + low_row * width_;
  const float* const low_selected = low.selected.data() + low_row * width_;
  const float* const high_values = high.values.data() + high_row * width_ + ahead;
  const float* const high_selected = high.selected.data() + high_row * width_ + ahead;
  float* __restrict const differences = sums_.differences.data();
  float* __restrict const squares = sums_.squares.data();
  float* __restrict const pairs = sums_.pairs.data();
  for (std::int64_t n = begin_ - 1; n < end_ + 1 - ahead; ++n) {
    const float pair = weight * low_selected[n] * high_selected[n];
    const float difference = high_values[n] - low_values[n];
    pairs[n] += pair;
    differences[n] += pair * difference;
    squares[n] += pair * difference * difference;
  }
}

/// Weights the sums at the positions before, at and after each voxel, divides by the pairs, and clears.
void GreyGradient::finish(std::size_t axis, const std::array<float, 3>& weights) {
  const auto around = [&](const std::vector<float>& sums, std::int64_t n) {
    const float* const at = sums.data() + n;
    return weights[0] * at[-1] + weights[1] * at[0] + weights[2] * at[1];
  };
  float* __restrict const means = means_[axis].data();
  float* __restrict const lengths = lengths_.data();
  float* __restrict const squares = squares_.data();
  const float per_mm_squared = per_mm_squared_[axis];
  for (std::int64_t n = begin_; n < end_; ++n) {
    const float pairs = around(sums_.pairs, n);
    const float per_pair = 1 / std::max(pairs, 1e-30f);
    const float mean = around(sums_.differences, n) * per_pair;
    means[n - 1] = mean;
    lengths[n - 1] += mean * mean * per_mm_squared;
    squares[n - 1] += around(sums_.squares, n) * per_pair * per_mm_squared;
  }
  for (std::vector<float>* row : {&sums_.differences, &sums_.squares, &sums_.pairs})
    std::fill(row->begin() + begin_ - 1, row->begin() + end_ + 1, 0.0f);
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
  begin_ = segment.begin;
  end_ = segment.end;
  for (std::vector<float>* sums : {&lengths_, &squares_})
    std::fill(sums->begin() + begin_ - 1, sums->begin() + end_ - 1, 0.0f);

  constexpr std::array<float, 3> kAcross{0.5f, 1, 0.5f};
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::int64_t r = 0; r < 3; ++r)
      add_pairs(planes_[s], planes_[s], row_ + r - 1, row_ + r - 1, 1,
                kAcross[s] * kAcross[static_cast<std::size_t>(r)]);
  }
  finish(0, {1, 1, 0});
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::int64_t r = 0; r < 2; ++r)
      add_pairs(planes_[s], planes_[s], row_ + r - 1, row_ + r, 0, kAcross[s]);
  }
  finish(1, kAcross);
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::int64_t r = 0; r < 3; ++r)
      add_pairs(planes_[s], planes_[s + 1], row_ + r - 1, row_ + r - 1, 0,
                kAcross[static_cast<std::size_t>(r)]);
  }
  finish(2, kAcross);
}

}  // namespace splatlas
