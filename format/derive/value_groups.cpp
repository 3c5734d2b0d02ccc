#include "format/derive/value_groups.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <type_traits>

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

namespace {

constexpr std::int64_t kLast = (std::int64_t{1} << kMeanLevel) - 1;  // voxel of a block along an axis

/// Blocks of a box, column by column of a slice.
class BlockSlices {
 public:
  BlockSlices(const IndexBox& box, const Index3& size)
      : blocks_(box_of_blocks(box)),
        rows_(size[1]),
        width_(blocks_.last[0] - blocks_.first[0] + 1),
        extents_(static_cast<std::size_t>(blocks_.last[1] - blocks_.first[1] + 1), {width_, 0}),
        counts_(extents_.size() * static_cast<std::size_t>(width_)) {}

  [[nodiscard]] std::size_t columns() const { return counts_.size(); }
  [[nodiscard]] std::int64_t row_of(std::size_t column) const {
    return blocks_.first[1] + static_cast<std::int64_t>(column) / width_;
  }
  [[nodiscard]] std::int64_t place_of(std::size_t column) const {
    return blocks_.first[0] + static_cast<std::int64_t>(column) % width_;
  }

  /// Calls add(column, n-th voxel, voxels) for the pieces of runs, and take(slice, column, voxels) for blocks
  /// with voxels, once a slice of them is complete.
  template <typename Add, typename Take>
  void visit(std::span<const ClassSpan> spans, const Add& add, const Take& take) {
    TaskPace pace;
    std::int64_t slice = -1;
    std::size_t voxel = 0;
    for (const ClassSpan& span : spans) {
      pace.step();
      const auto scanline = static_cast<std::int64_t>(span.run.scanline);
      const std::int64_t of = (scanline / rows_) >> kMeanLevel;
      if (of != slice) finish(slice, take);
      slice = of;
      const std::int64_t row = ((scanline % rows_) >> kMeanLevel) - blocks_.first[1];
      const std::int64_t end = std::int64_t{span.run.start} + span.run.length;
      extend(row, (span.run.start >> kMeanLevel) - blocks_.first[0],
             ((end - 1) >> kMeanLevel) - blocks_.first[0]);
      for (std::int64_t begin = span.run.start; begin < end;) {
        const std::int64_t next = std::min(end, (begin | kLast) + 1);
        const auto column = static_cast<std::size_t>(row * width_ + (begin >> kMeanLevel) - blocks_.first[0]);
        const auto count = static_cast<std::size_t>(next - begin);
        counts_[column] = static_cast<std::uint8_t>(counts_[column] + count);
        add(column, voxel, count);
        voxel += count;
        begin = next;
      }
    }
    finish(slice, take);
  }

 private:
  /// Columns [first, last] of a row, relative to it; none if first > last.
  struct Extent {
    std::int64_t first = 0, last = 0;
  };

  void extend(std::int64_t row, std::int64_t first, std::int64_t last) {
    Extent& extent = extents_[static_cast<std::size_t>(row)];
    if (extent.first > extent.last) touched_.push_back(row);
    extent = {std::min(extent.first, first), std::max(extent.last, last)};
  }
  template <typename Take>
  void finish(std::int64_t slice, const Take& take) {
    check_task();
    std::ranges::sort(touched_);
    for (const std::int64_t row : touched_) {
      const Extent extent = std::exchange(extents_[static_cast<std::size_t>(row)], {width_, 0});
      for (std::int64_t n = row * width_ + extent.first; n <= row * width_ + extent.last; ++n) {
        const auto column = static_cast<std::size_t>(n);
        if (counts_[column] == 0) continue;
        take(slice, column, counts_[column]);
        counts_[column] = 0;
      }
    }
    touched_.clear();
  }

  const IndexBox blocks_;
  const std::int64_t rows_, width_;
  // Of the current slice
  std::vector<std::int64_t> touched_;  // rows with voxels
  std::vector<Extent> extents_;        // [row]
  std::vector<std::uint8_t> counts_;   // [column]
};

/// Nearest integer to a mean, halves upwards.
template <typename T>
T mean_of(std::int64_t sum, std::int64_t count) {
  const std::int64_t twice = 2 * sum + count, unit = 2 * count;
  return static_cast<T>(twice / unit - (twice % unit < 0 ? 1 : 0));
}
template <typename T>
T mean_of(double sum, std::int64_t count) {
  const double mean = sum / static_cast<double>(count);
  return std::isnan(mean) ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(mean);
}

}  // namespace

IndexBox box_of_blocks(const IndexBox& box) {
  IndexBox blocks = box;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks.first[a] >>= kMeanLevel;
    blocks.last[a] >>= kMeanLevel;
  }
  return blocks;
}

Index3 blocks_of_grid(const Index3& size) {
  Index3 blocks = size;
  for (std::int64_t& n : blocks) n = ((n - 1) >> kMeanLevel) + 1;
  return blocks;
}

bool may_have_means(const IndexBox& box) {
  constexpr std::int64_t kMaxColumns = std::int64_t{1} << 24;
  const IndexBox of_box = box_of_blocks(box);
  const std::int64_t width = of_box.last[0] - of_box.first[0] + 1;
  return !box.empty() && of_box.last[1] - of_box.first[1] < kMaxColumns / width &&
         of_box.voxels() <= std::numeric_limits<std::uint32_t>::max();
}

GroupBlocks blocks_of(std::span<const ClassSpan> spans, const IndexBox& box, const Index3& size) {
  const auto rows = static_cast<std::uint64_t>(blocks_of_grid(size)[1]);
  GroupBlocks blocks;
  BlockSlices slices(box, size);
  slices.visit(
      spans, [](auto...) {},
      [&](std::int64_t slice, std::size_t column, std::uint8_t voxels) {
        const Run block{
            static_cast<std::uint64_t>(slice) * rows + static_cast<std::uint64_t>(slices.row_of(column)),
            static_cast<std::uint32_t>(slices.place_of(column)), 1};
        if (!blocks.spans.empty()) {
          Run& before = blocks.spans.back().run;
          if (before.scanline == block.scanline && before.start + before.length == block.start) {
            ++before.length;
            blocks.voxels.push_back(voxels);
            return;
          }
        }
        blocks.spans.push_back({block, kEmptyClass});
        blocks.voxels.push_back(voxels);
      });
  return blocks;
}

std::vector<std::byte> block_means(std::span<const ClassSpan> spans, const IndexBox& box, const Index3& size,
                                   VoxelType type, std::span<const std::byte> values) {
  std::vector<std::byte> means;
  visit_voxel_type(type, [&](auto tag) {
    using T = decltype(tag);
    using Sum = std::conditional_t<std::is_floating_point_v<T>, double, std::int64_t>;
    BlockSlices slices(box, size);
    std::vector<Sum> sums(slices.columns());
    slices.visit(
        spans,
        [&](std::size_t column, std::size_t voxel, std::size_t count) {
          for (std::size_t n = voxel; n < voxel + count; ++n) {
            T value;
            std::memcpy(&value, values.data() + n * sizeof(T), sizeof(T));
            sums[column] += static_cast<Sum>(value);
          }
        },
        [&](std::int64_t /*slice*/, std::size_t column, std::uint8_t voxels) {
          const T mean = mean_of<T>(std::exchange(sums[column], 0), voxels);
          const auto* const bytes = reinterpret_cast<const std::byte*>(&mean);
          means.insert(means.end(), bytes, bytes + sizeof(T));
        });
  });
  return means;
}

}  // namespace splatlas
