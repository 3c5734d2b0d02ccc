#include "format/derive/part_rows.h"

#include <algorithm>
#include <utility>

#include "format/tasks/free_memory.h"
#include "format/tasks/task_control.h"

namespace splatlas {

void PartRows::add(std::span<const Run> runs, std::uint8_t part) {
  check_memory(kMaxBytesPerRun * static_cast<double>(placed_.size() + runs.size()));
  check_task();
  for (const Run& run : runs)
    placed_.push_back({run.scanline, {run.start, std::int64_t{run.start} + run.length, part}});
}

void PartRows::sort() {
  TaskPace pace;
  std::ranges::sort(placed_, [&](const PlacedRun& a, const PlacedRun& b) {
    pace.step();
    return std::pair(a.scanline, a.run.start) < std::pair(b.scanline, b.run.start);
  });
  runs_.reserve(placed_.size());
  std::size_t rows = 0;
  for (std::size_t n = 0; n < placed_.size(); ++n)
    rows += n == 0 || placed_[n].scanline != placed_[n - 1].scanline ? 1 : 0;
  rows_.reserve(rows);
  for (std::size_t n = 0; n < placed_.size(); ++n) {
    if (n == 0 || placed_[n].scanline != placed_[n - 1].scanline) {
      const auto scanline = static_cast<std::int64_t>(placed_[n].scanline);
      rows_.push_back({scanline % size_[1], scanline / size_[1], n});
    }
    runs_.push_back(placed_[n].run);
  }
  free_memory(placed_);
}

std::span<const PartRun> PartRows::row(std::int64_t j, std::int64_t k) const {
  const auto place = [](const Row& row) { return std::pair(row.k, row.j); };
  const auto found = std::ranges::lower_bound(rows_, std::pair(k, j), {}, place);
  if (found == rows_.end() || place(*found) != std::pair(k, j)) return {};
  const auto next = found + 1;
  const std::size_t end = next == rows_.end() ? runs_.size() : next->first_run;
  return std::span(runs_).subspan(found->first_run, end - found->first_run);
}

}  // namespace splatlas
