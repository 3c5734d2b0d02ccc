#include "player/render/decode/selected_runs.h"

#include <algorithm>
#include <tuple>

namespace splatlas {

SelectedRuns::SelectedRuns(const DrawPlan& plan, const ClassTable& classes, const ClassCache& cache,
                           Axis axis)
    : axis_(axis), runs_(cache.runs(axis)), draw_of_class_(classes.size(), kNotDrawn) {
  IndexBox of_grid;
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    const ClassDraw& draw = plan.classes[n];
    if (!draws_volume(draw.role)) continue;
    draw_of_class_[draw.id] = n;
    of_grid.include(classes.box(draw.id));
    count_ += cache.run_count(draw.id, axis);
  }
  if (of_grid.empty()) return;
  const ScanOrder scan = ScanOrder::of(axis);
  const auto in_scan_order = [&](const Index3& voxel) {
    return Index3{voxel[scan.scan_axis], voxel[scan.row_axis], voxel[scan.slice_axis]};
  };
  box_ = {in_scan_order(of_grid.first), in_scan_order(of_grid.last)};
}

std::span<const ClassRun> SelectedRuns::decoded(std::int64_t slice, std::int64_t first_row,
                                                std::int64_t last_row) const {
  const std::span<const ClassRun> all = runs_.slice(slice);
  const auto row_begins = [&](std::int64_t row) {
    return std::partition_point(all.begin(), all.end(),
                                [row](const ClassRun& run) { return std::int64_t{run.row} < row; });
  };
  return {row_begins(first_row), row_begins(std::max(first_row, last_row))};
}

const ClassRun* SelectedRuns::at(std::int64_t slice, std::int64_t row, std::int64_t scan) const {
  const std::span<const ClassRun> all = runs_.slice(slice);
  const auto after = std::partition_point(all.begin(), all.end(), [&](const ClassRun& run) {
    return std::tuple(std::int64_t{run.row}, std::int64_t{run.start}) <= std::tuple(row, scan);
  });
  if (after == all.begin()) return nullptr;
  const ClassRun& run = *(after - 1);
  const bool contains = run.row == row && scan < std::int64_t{run.start} + run.length;
  return contains && draw_of_class_[run.id] != kNotDrawn ? &run : nullptr;
}

}  // namespace splatlas
