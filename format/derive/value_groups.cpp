#include "format/derive/value_groups.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "format/tasks/task_control.h"

namespace splatlas {

ValueGroups::ValueGroups(const ClassTable& table) {
  std::map<std::vector<std::uint64_t>, std::uint32_t> numbers;
  for (ClassId c = 0; c < table.size(); ++c) {
    std::vector<std::uint64_t> key;
    for (const Membership& m : table.members(c))
      key.push_back(std::uint64_t{m.structure} * 2 + (m.holds() ? 0 : 1));
    const auto [found, is_new] = numbers.emplace(std::move(key), static_cast<std::uint32_t>(classes.size()));
    if (is_new) classes.emplace_back();
    classes[found->second].push_back(c);
    group_of.push_back(found->second);
  }
}

std::vector<ClassId> ValueGroups::locating_classes(std::size_t group) const {
  if (classes[group].front() != kEmptyClass) return classes[group];
  std::vector<ClassId> all(group_of.size());
  std::iota(all.begin(), all.end(), ClassId{0});
  return all;
}

std::uint64_t group_voxels(const ValueGroups& groups, const ClassTable& table, std::size_t group) {
  std::uint64_t voxels = 0;
  for (const ClassId c : groups.classes[group]) voxels += table.voxels(c);
  return voxels;
}

IndexBox group_box(const ValueGroups& groups, const ClassTable& table, std::size_t group,
                   const Index3& size) {
  if (groups.classes[group].front() == kEmptyClass)
    return {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
  IndexBox box;
  for (const ClassId c : groups.classes[group]) box.include(table.box(c));
  return box;
}

std::vector<ClassSpan> merge_runs(std::span<const ClassId> classes, std::span<const ClassRuns> runs) {
  std::vector<ClassSpan> spans;
  std::vector<std::ptrdiff_t> ends{0};
  for (std::size_t n = 0; n < classes.size(); ++n) {
    for (const Run& run : runs[n]) spans.push_back({run, classes[n]});
    ends.push_back(static_cast<std::ptrdiff_t>(spans.size()));
  }
  const auto before = [](const ClassSpan& a, const ClassSpan& b) { return a.run < b.run; };
  while (ends.size() > 2) {  // merge adjacent lists in pairs
    std::vector<std::ptrdiff_t> merged{0};
    for (std::size_t n = 0; n + 1 < ends.size(); n += 2) {
      check_task();
      const std::ptrdiff_t last = ends[std::min(n + 2, ends.size() - 1)];
      std::inplace_merge(spans.begin() + ends[n], spans.begin() + ends[n + 1], spans.begin() + last, before);
      merged.push_back(last);
    }
    ends = std::move(merged);
  }
  return spans;
}

std::vector<ClassSpan> gaps_between(std::span<const ClassSpan> spans, const Index3& size) {
  std::vector<ClassSpan> gaps;
  const auto width = static_cast<std::uint64_t>(size[0]);
  const auto scanlines = static_cast<std::uint64_t>(size[1] * size[2]);
  std::uint64_t scanline = 0, at = 0;
  // Adds the gap from `at` to `end` in the scanline.
  TaskPace pace;
  const auto close = [&](std::uint64_t end) {
    pace.step();
    if (at < end) {
      gaps.push_back(
          {{scanline, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(end - at)}, kEmptyClass});
    }
    at = std::max(at, end);
  };
  const auto next_scanline = [&] {
    close(width);
    if (gaps.size() == gaps.capacity())
      check_memory(2.0 * sizeof(ClassSpan) * static_cast<double>(gaps.size()));
    ++scanline;
    at = 0;
  };
  for (const ClassSpan& span : spans) {
    while (scanline < span.run.scanline) next_scanline();
    close(span.run.start);
    at = std::max(at, std::uint64_t{span.run.start} + span.run.length);
  }
  while (scanline < scanlines) next_scanline();
  return gaps;
}

std::vector<ClassSpan> group_spans(const ValueGroups& groups, std::size_t group,
                                   std::span<const ClassRuns> runs, const Index3& size) {
  std::vector<ClassSpan> spans = merge_runs(groups.locating_classes(group), runs);
  return groups.classes[group].front() == kEmptyClass ? gaps_between(spans, size) : spans;
}

}  // namespace splatlas
