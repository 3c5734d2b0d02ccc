#include "format/boundary_split.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace splatlas {
namespace {

/// Voxels first to end - 1 of a scanline.
struct Interval {
  std::int64_t begin = 0, end = 0;
};

/// The runs around a scanline, and what of it they leave interior.
class ScanlineWindow {
 public:
  ScanlineWindow(std::span<const Run> runs, const Index3& size, Axis axis) : runs_(runs) {
    const ScanOrder order = ScanOrder::of(axis);
    rows_ = size[order.row_axis];
    slices_ = size[order.slice_axis];
  }

  /// Interior voxels of the scanline whose runs are first to end - 1. Scanlines come in order.
  const std::vector<Interval>& interior(std::size_t first, std::size_t end) {
    const auto scanline = static_cast<std::int64_t>(runs_[first].scanline);
    const std::int64_t row = scanline % rows_, slice = scanline / rows_;
    kept_.clear();
    for (std::size_t n = first; n < end; ++n) keep_shrunk(n);
    std::size_t cursor = 0;
    for (std::int64_t d_slice = -1; d_slice <= 1; ++d_slice) {
      for (std::int64_t d_row = -1; d_row <= 1; ++d_row, ++cursor) {
        if ((d_slice == 0 && d_row == 0) || kept_.empty()) continue;
        const std::int64_t other_row = row + d_row, other_slice = slice + d_slice;
        if (other_row < 0 || other_row >= rows_ || other_slice < 0 || other_slice >= slices_) {
          kept_.clear();
          continue;
        }
        // Those that share an edge have one voxel to be covered, those that share a face three.
        const std::int64_t margin = d_slice != 0 && d_row != 0 ? 0 : 1;
        intersect(static_cast<std::uint64_t>(other_slice * rows_ + other_row), margin, cursors_[cursor]);
      }
    }
    return kept_;
  }

 private:
  void keep_shrunk(std::size_t n) {
    const Interval inner{std::int64_t{runs_[n].start} + 1,
                         std::int64_t{runs_[n].start} + runs_[n].length - 1};
    if (inner.begin < inner.end) kept_.push_back(inner);
  }

  /// With the runs of another scanline, shrunk by `margin`; `cursor` only ever moves on.
  void intersect(std::uint64_t scanline, std::int64_t margin, std::size_t& cursor) {
    while (cursor < runs_.size() && runs_[cursor].scanline < scanline) ++cursor;
    met_.clear();
    std::size_t n = cursor;
    for (const Interval& kept : kept_) {
      for (; n < runs_.size() && runs_[n].scanline == scanline; ++n) {
        const std::int64_t begin = std::int64_t{runs_[n].start} + margin;
        const std::int64_t end = std::int64_t{runs_[n].start} + runs_[n].length - margin;
        const Interval both{std::max(kept.begin, begin), std::min(kept.end, end)};
        if (both.begin < both.end) met_.push_back(both);
        if (end > kept.end) break;  // it may reach into the next one
      }
    }
    std::swap(kept_, met_);
  }

  std::span<const Run> runs_;
  std::int64_t rows_ = 0, slices_ = 0;
  std::array<std::size_t, 9> cursors_{};
  std::vector<Interval> kept_, met_;
};

void add_run(std::uint64_t scanline, std::int64_t begin, std::int64_t end, ClassRuns& runs) {
  if (begin < end)
    runs.push_back({scanline, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
}

}  // namespace

ClassRuns join_runs(std::span<const Run> a, std::span<const Run> b) {
  ClassRuns both(a.size() + b.size());
  std::ranges::merge(a, b, both.begin());
  std::size_t last = 0;
  for (std::size_t n = 1; n < both.size(); ++n) {
    Run& before = both[last];
    if (before.scanline == both[n].scanline && before.start + before.length == both[n].start) {
      before.length += both[n].length;
    } else {
      both[++last] = both[n];
    }
  }
  if (!both.empty()) both.resize(last + 1);
  return both;
}

SplitRuns split_boundary(std::span<const Run> runs, const Index3& size, Axis axis) {
  SplitRuns split;
  ScanlineWindow window(runs, size, axis);
  for (std::size_t first = 0; first < runs.size();) {
    const std::uint64_t scanline = runs[first].scanline;
    std::size_t end = first;
    while (end < runs.size() && runs[end].scanline == scanline) ++end;
    const std::vector<Interval>& interior = window.interior(first, end);
    auto inner = interior.begin();
    for (; first < end; ++first) {
      std::int64_t at = runs[first].start;
      const std::int64_t stop = at + runs[first].length;
      for (; inner != interior.end() && inner->begin < stop; ++inner) {
        add_run(scanline, at, inner->begin, split.boundary);
        add_run(scanline, inner->begin, inner->end, split.interior);
        at = inner->end;
      }
      add_run(scanline, at, stop, split.boundary);
    }
  }
  return split;
}

RunStreams::RunStreams(const ClassTable& table) : groups_(table), split_(find_split_groups(groups_, table)) {}

std::vector<bool> find_split_groups(const ValueGroups& groups, const ClassTable& table) {
  constexpr std::size_t kNoGroup = std::numeric_limits<std::size_t>::max();
  constexpr std::size_t kSeveral = kNoGroup - 1;
  std::vector<std::size_t> holder;  // [structure]: the group that holds it
  for (ClassId c = 0; c < table.size(); ++c) {
    for (const Membership& m : table.members(c)) {
      if (m.part == Part::kCrossed) continue;
      if (m.structure >= holder.size()) holder.resize(m.structure + std::size_t{1}, kNoGroup);
      std::size_t& of = holder[m.structure];
      of = of == kNoGroup || of == groups.group_of[c] ? groups.group_of[c] : kSeveral;
    }
  }
  const auto all_are = [&](ClassId c, Part part) {
    return std::ranges::all_of(table.members(c), [&](const Membership& m) {
      return m.part == part && holder[m.structure] == groups.group_of[c];
    });
  };
  std::vector<bool> split;
  for (const std::vector<ClassId>& of : groups.classes)
    split.push_back(of.size() == 2 && all_are(of[0], Part::kInterior) && all_are(of[1], Part::kBoundary));
  return split;
}

}  // namespace splatlas
