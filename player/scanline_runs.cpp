#include "player/scanline_runs.h"

#include <algorithm>
#include <limits>

namespace splatlas {
namespace {

/// Sorts by row, then start: rows by counting, the few runs of a row by comparing.
void sort_runs(std::vector<ClassRun>& runs) {
  const auto [lowest, highest] = std::minmax_element(
      runs.begin(), runs.end(), [](const ClassRun& a, const ClassRun& b) { return a.row < b.row; });
  const std::uint32_t first_row = lowest->row;
  std::vector<std::uint32_t> next(highest->row - first_row + 2);  // place of the next run of each row
  for (const ClassRun& run : runs) ++next[run.row - first_row + 1];
  for (std::size_t row = 1; row < next.size(); ++row) next[row] += next[row - 1];
  std::vector<ClassRun> sorted(runs.size());
  for (const ClassRun& run : runs) sorted[next[run.row - first_row]++] = run;
  auto begin = sorted.begin();
  for (std::size_t row = 0; row + 1 < next.size(); ++row) {
    const auto end = sorted.begin() + next[row];
    std::sort(begin, end, [](const ClassRun& a, const ClassRun& b) { return a.start < b.start; });
    begin = end;
  }
  runs = std::move(sorted);
}

}  // namespace

/// Slices [first, last) of the grid.
void ScanlineRuns::make_room(std::int64_t first, std::int64_t last) {
  if (slices_.empty()) first_ = first;
  if (first < first_) {
    slices_.insert(slices_.begin(), static_cast<std::size_t>(first_ - first), {});
    first_ = first;
  }
  slices_.resize(std::max(slices_.size(), static_cast<std::size_t>(last - first_)));
}

void ScanlineRuns::insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
                          ThreadPool& pool) {
  const auto slice_of = [rows](const Run& run) {
    return static_cast<std::int64_t>(run.scanline / static_cast<std::uint64_t>(rows));
  };
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;
  for (const auto& [id, runs] : classes) {
    if (runs->empty()) continue;
    first = std::min(first, slice_of(runs->front()));
    last = std::max(last, slice_of(runs->back()) + 1);
  }
  if (first >= last) return;
  make_room(first, last);

  std::vector<std::uint8_t> touched(slices_.size());
  for (const auto& [id, runs] : classes) {
    std::size_t slice = 0;
    std::uint64_t begin = 0, end = 0;  // scanlines of that slice
    for (const Run& run : *runs) {
      if (run.scanline >= end) {
        const std::int64_t of_grid = slice_of(run);
        slice = static_cast<std::size_t>(of_grid - first_);
        begin = static_cast<std::uint64_t>(of_grid) * static_cast<std::uint64_t>(rows);
        end = begin + static_cast<std::uint64_t>(rows);
        touched[slice] = 1;
      }
      slices_[slice].push_back({static_cast<std::uint32_t>(run.scanline - begin), run.start, run.length, id});
    }
  }
  pool.for_each(slices_.size(), [&](std::size_t n) {
    if (touched[n] != 0) sort_runs(slices_[n]);
  });
}

}  // namespace splatlas
