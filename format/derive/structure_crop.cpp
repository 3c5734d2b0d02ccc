#include "format/derive/structure_crop.h"

#include <algorithm>
#include <numeric>

#include "format/tasks/free_memory.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Calls visit(class, membership) for every membership inside a structure.
template <typename Visit>
void for_each_holding(const ClassTable& classes, const Visit& visit) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.holds()) visit(c, m);
    }
  }
}

}  // namespace

StructureClasses::StructureClasses(const ClassTable& classes, std::size_t structures)
    : first_(structures + 1, 0) {
  for_each_holding(classes, [&](ClassId, const Membership& m) { ++first_[m.structure + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  list_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each_holding(classes, [&](ClassId c, const Membership& m) {
    list_[next[m.structure]++] = {c, m.part};
  });
}

IndexBox box_of(const ClassTable& classes, std::span<const StructureClass> members) {
  IndexBox box;
  for (const StructureClass& h : members) box.include(classes.box(h.id));
  return box;
}

std::vector<std::uint8_t> parts_of(std::span<const StructureClass> members, std::size_t classes) {
  std::vector<std::uint8_t> parts(classes, StructureCrop::kOutside);
  for (const StructureClass& h : members) parts[h.id] = StructureCrop::part_of(h.part);
  return parts;
}

StructureCrop crop_structure(const RunModel& runs, std::int64_t rows, const IndexBox& box,
                             std::span<const StructureClass> members) {
  StructureCrop crop = empty_crop(box);
  for (const StructureClass& h : members)
    paint_runs(runs.classes[h.id], rows, StructureCrop::part_of(h.part), crop);
  return crop;
}

StructureCrop empty_crop(const IndexBox& box) {
  StructureCrop crop;
  for (std::size_t a = 0; a < 3; ++a) {
    crop.first[a] = box.first[a] - 1;
    crop.size[a] = box.last[a] - box.first[a] + 3;
  }
  crop.parts.resize(static_cast<std::size_t>(crop.size[0] * crop.size[1] * crop.size[2]),
                    StructureCrop::kOutside);
  return crop;
}

void paint_runs(std::span<const Run> runs, std::int64_t rows, std::uint8_t part, StructureCrop& crop) {
  for (const Run& run : runs) {
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    const std::int64_t j = scanline % rows - crop.first[1], k = scanline / rows - crop.first[2];
    if (j < 0 || k < 0 || j >= crop.size[1] || k >= crop.size[2]) continue;
    const std::int64_t begin = std::max<std::int64_t>(run.start - crop.first[0], 0);
    const std::int64_t end =
        std::min<std::int64_t>(std::int64_t{run.start} + run.length - crop.first[0], crop.size[0]);
    if (begin < end) std::fill_n(&crop.parts[crop.offset(begin, j, k)], end - begin, part);
  }
}

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
