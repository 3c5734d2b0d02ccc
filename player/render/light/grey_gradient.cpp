#include "player/render/light/grey_gradient.h"

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
  light_kernels().gradient(rows, static_cast<std::size_t>(segment.end - segment.begin), scale_, sums,
                           row_from(segment.begin - 1));
}

}  // namespace splatlas
