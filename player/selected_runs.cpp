#include "player/selected_runs.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace splatlas {
namespace {

IndexBox selected_box(const DrawPlan& plan, const ClassTable& classes) {
  IndexBox box;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) box.include(classes.box(draw.id));
  }
  return box;
}

}  // namespace

Result<SelectedRuns> merge_runs(const DrawPlan& plan, const Atlas& atlas, const ClassCache& cache,
                                Axis axis) {
  SelectedRuns selected;
  selected.axis = axis;
  const IndexBox box = selected_box(plan, atlas.classes());
  if (box.empty()) return selected;
  const ScanOrder scan = ScanOrder::of(axis);
  selected.slice_first = box.first[scan.slice_axis];
  selected.slices = box.last[scan.slice_axis] - selected.slice_first + 1;
  selected.row_first = box.first[scan.row_axis];
  selected.rows = box.last[scan.row_axis] - selected.row_first + 1;
  selected.scan_first = box.first[scan.scan_axis];
  selected.scan_voxels = box.last[scan.scan_axis] - selected.scan_first + 1;

  // Scanline numbers of the grid become numbers within the box.
  const auto grid_rows = static_cast<std::uint64_t>(atlas.grid().size[scan.row_axis]);
  const auto number_in_box = [&](std::uint64_t scanline) {
    const auto slice = static_cast<std::int64_t>(scanline / grid_rows);
    const auto row = static_cast<std::int64_t>(scanline % grid_rows);
    return static_cast<std::size_t>((slice - selected.slice_first) * selected.rows +
                                    (row - selected.row_first));
  };

  // Count per scanline.
  std::uint64_t total = 0;
  selected.first_run.assign(static_cast<std::size_t>(selected.slices * selected.rows) + 1, 0);
  for (const ClassDraw& draw : plan.classes) {
    if (!draws_volume(draw.role)) continue;
    const ClassRuns& runs = cache.runs(draw.id, axis);
    total += runs.size();
    if (total > std::numeric_limits<std::uint32_t>::max()) {
      return fail(ErrorCode::kLimit, fmt::format("{}: the selection has more than 2^32 runs", atlas.name()));
    }
    for (const Run& run : runs) ++selected.first_run[number_in_box(run.scanline) + 1];
  }
  for (std::size_t n = 1; n < selected.first_run.size(); ++n)
    selected.first_run[n] += selected.first_run[n - 1];

  // Place. Afterwards first_run[n] has moved to the end of scanline n, which is where n + 1 starts: shift
  // back.
  selected.runs.resize(total);
  for (std::uint32_t d = 0; d < plan.classes.size(); ++d) {
    if (!draws_volume(plan.classes[d].role)) continue;
    for (const Run& run : cache.runs(plan.classes[d].id, axis)) {
      selected.runs[selected.first_run[number_in_box(run.scanline)]++] = {run.start, run.length, d};
    }
  }
  std::copy_backward(selected.first_run.begin(), selected.first_run.end() - 1, selected.first_run.end());
  selected.first_run[0] = 0;

  for (std::size_t n = 0; n + 1 < selected.first_run.size(); ++n) {
    std::sort(selected.runs.begin() + selected.first_run[n],
              selected.runs.begin() + selected.first_run[n + 1],
              [](const SelectedRun& a, const SelectedRun& b) { return a.start < b.start; });
  }
  return selected;
}

}  // namespace splatlas
