#include "bench/experiments/run_collector.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace splatlas {
namespace {

bool starts_before(const FoundRun& a, const FoundRun& b) {
  return a.start < b.start;
}

/// Merges touching and overlapping runs of one draw. Returns the new end.
FoundRun* unite(FoundRun* first, FoundRun* last) {
  if (first == last) return last;
  FoundRun* united = first;
  for (const FoundRun* run = first + 1; run != last; ++run) {
    const std::uint32_t end = united->start + united->length;
    if (run->draw == united->draw && run->start <= end) {
      united->length = std::max(end, run->start + run->length) - united->start;
    } else {
      *++united = *run;
    }
  }
  return united + 1;
}

}  // namespace

std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes) {
  std::vector<std::uint32_t> draws(classes, kNotDrawn);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draws[plan.classes[n].id] = n;
  }
  return draws;
}

std::vector<std::uint32_t> shared_draws_by_class(const DrawPlan& plan,
                                                 std::span<const VolumeAppearance> appearances,
                                                 std::size_t classes) {
  std::vector<std::uint32_t> draws = draws_by_class(plan, classes);
  std::map<std::tuple<std::array<float, 3>, float, const TransferTable*>, std::uint32_t> first;
  for (std::uint32_t& draw : draws) {
    if (draw == kNotDrawn) continue;
    const VolumeAppearance& appearance = appearances[draw];
    draw = first.try_emplace({appearance.color, appearance.extinction_per_mm, appearance.transfer}, draw)
               .first->second;
  }
  return draws;
}

IndexBox drawn_box(const DrawPlan& plan, const ClassTable& classes) {
  IndexBox box;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) box.include(classes.box(draw.id));
  }
  return box;
}

RunCollector::RunCollector(const IndexBox& box, Axis axis) : scan_(ScanOrder::of(axis)) {
  if (box.empty()) return;
  slice_first_ = box.first[scan_.slice_axis];
  slices_ = box.last[scan_.slice_axis] - slice_first_ + 1;
  row_first_ = box.first[scan_.row_axis];
  rows_ = box.last[scan_.row_axis] - row_first_ + 1;
  first_run_.assign(static_cast<std::size_t>(slices_ * rows_) + 1, 0);
}

FoundRuns RunCollector::finish() {
  FoundRuns found;
  found.slice_first = slice_first_;
  if (first_run_.empty()) return found;
  for (std::size_t n = 1; n < first_run_.size(); ++n) first_run_[n] += first_run_[n - 1];
  found.runs.resize(collected_.size());
  std::vector<std::uint32_t> next = first_run_;
  for (const Collected& collected : collected_) found.runs[next[collected.scanline]++] = collected.run;

  FoundRun* const runs = found.runs.data();
  FoundRun* end = runs;
  for (std::int64_t slice = 0; slice < slices_; ++slice) {
    found.first_run.push_back(static_cast<std::uint32_t>(end - runs));
    for (std::int64_t row = 0; row < rows_; ++row) {
      const std::uint32_t* const first = &first_run_[static_cast<std::size_t>(slice * rows_ + row)];
      FoundRun* const from = runs + first[0];
      FoundRun* const to = runs + first[1];
      if (!std::is_sorted(from, to, starts_before)) std::sort(from, to, starts_before);
      end = std::copy(from, unite(from, to), end);
    }
  }
  found.first_run.push_back(static_cast<std::uint32_t>(end - runs));
  found.runs.resize(static_cast<std::size_t>(end - runs));
  return found;
}

}  // namespace splatlas
