#include "format/derive/boundary_split.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

constexpr std::uint32_t kWordBits = 64;

/// Bit mask of the voxels of a scanline, padded by one word on both sides.
class ScanlineBits {
 public:
  explicit ScanlineBits(std::int64_t width) : words_(static_cast<std::size_t>(width) / kWordBits + 3) {}

  [[nodiscard]] std::uint64_t scanline() const { return scanline_; }
  [[nodiscard]] const std::uint64_t* words() const { return words_.data() + 1; }

  /// Replaces the content by the runs of another scanline. Cost: linear in runs and in voxels / 64.
  void load(std::uint64_t scanline, std::span<const Run> runs) {
    for (const Run& run : runs_)
      for_each_word(run, [&](std::size_t word, std::uint64_t) { words_[word] = 0; });
    for (const Run& run : runs)
      for_each_word(run, [&](std::size_t word, std::uint64_t bits) { words_[word] |= bits; });
    runs_ = runs;
    scanline_ = scanline;
  }

 private:
  template <typename Visit>
  static void for_each_word(const Run& run, Visit&& visit) {
    const std::uint64_t end = std::uint64_t{run.start} + run.length;
    for (std::uint64_t at = run.start; at < end;) {
      const std::uint64_t word = at / kWordBits, next = std::min(end, (word + 1) * kWordBits);
      const std::uint64_t bits = ~std::uint64_t{0} >> (kWordBits - (next - at)) << at % kWordBits;
      visit(static_cast<std::size_t>(word) + 1, bits);
      at = next;
    }
  }

  std::vector<std::uint64_t> words_;
  std::span<const Run> runs_;
  std::uint64_t scanline_ = std::numeric_limits<std::uint64_t>::max();
};

/// Bit masks of the 3 x 3 scanlines around the current one, and its interior voxels.
class ScanlineWindow {
 public:
  ScanlineWindow(std::span<const Run> runs, const Index3& size, Axis axis) : runs_(runs) {
    const ScanOrder order = ScanOrder::of(axis);
    rows_ = size[order.row_axis];
    slices_ = size[order.slice_axis];
    const std::int64_t width = size[order.scan_axis];
    lines_.assign(9, ScanlineBits(width));
    interior_.resize(static_cast<std::size_t>(width) / kWordBits + 1);
  }

  /// Moves to a scanline. Call in scanline order. False at the border of the grid: no voxel is interior.
  bool go_to(std::uint64_t scanline) {
    const auto row = static_cast<std::int64_t>(scanline) % rows_,
               slice = static_cast<std::int64_t>(scanline) / rows_;
    if (row == 0 || row == rows_ - 1 || slice == 0 || slice == slices_ - 1) return false;
    for (std::size_t d_slice = 0; d_slice < 3; ++d_slice) {
      for (std::size_t d_row = 0; d_row < 3; ++d_row) {
        const auto rows = static_cast<std::uint64_t>(rows_);
        around_[d_slice][d_row] = load(d_slice, scanline + d_slice * rows + d_row - rows - 1);
      }
    }
    return true;
  }

  /// Calls visit(begin, end) for the interior intervals of a run of that scanline, in order.
  template <typename Visit>
  void for_each_interior(const Run& run, Visit&& visit) {
    const std::uint64_t stop = std::uint64_t{run.start} + run.length;
    for (std::uint64_t word = run.start / kWordBits; word * kWordBits < stop; ++word)
      interior_[word] = interior(word);
    for (std::uint64_t at = run.start; at < stop;) {
      const std::uint64_t begin = find(at, stop, 0), end = find(begin, stop, ~std::uint64_t{0});
      if (begin < end) visit(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end));
      at = end;
    }
  }

 private:
  /// Bits of a scanline. Scanlines of each slice come in order, so that each is loaded once per d_slice.
  const std::uint64_t* load(std::size_t d_slice, std::uint64_t scanline) {
    ScanlineBits& line = lines_[3 * d_slice + scanline % 3];
    if (line.scanline() != scanline) {
      std::size_t& cursor = cursors_[d_slice];
      while (cursor < runs_.size() && runs_[cursor].scanline < scanline) ++cursor;
      const std::size_t first = cursor;
      while (cursor < runs_.size() && runs_[cursor].scanline == scanline) ++cursor;
      line.load(scanline, runs_.subspan(first, cursor - first));
    }
    return line.words();
  }

  /// Voxels that are covered, with covered face neighbours in the adjacent rows and slices.
  [[nodiscard]] std::uint64_t cross(std::ptrdiff_t word) const {
    return around_[1][1][word] & around_[0][1][word] & around_[2][1][word] & around_[1][0][word] &
           around_[1][2][word];
  }
  /// Interior voxels: cross() of voxel and both neighbours in the scanline, and four more edge neighbours.
  [[nodiscard]] std::uint64_t interior(std::uint64_t at) const {
    const auto word = static_cast<std::ptrdiff_t>(at);
    const std::uint64_t here = cross(word);
    if (here == 0) return 0;
    const std::uint64_t edges =
        around_[0][0][word] & around_[0][2][word] & around_[2][0][word] & around_[2][2][word];
    return here & (here << 1 | cross(word - 1) >> (kWordBits - 1)) &
           (here >> 1 | cross(word + 1) << (kWordBits - 1)) & edges;
  }

  /// The first voxel from `at` with a bit other than in `same`, or `stop`.
  [[nodiscard]] std::uint64_t find(std::uint64_t at, std::uint64_t stop, std::uint64_t same) const {
    while (at < stop) {
      const std::uint64_t bits = (interior_[at / kWordBits] ^ same) >> at % kWordBits;
      if (bits != 0) return std::min(stop, at + static_cast<std::uint64_t>(std::countr_zero(bits)));
      at = (at / kWordBits + 1) * kWordBits;
    }
    return stop;
  }

  std::span<const Run> runs_;
  std::int64_t rows_ = 0, slices_ = 0;
  std::vector<ScanlineBits> lines_;  // [3 * d_slice + scanline % 3]
  std::array<std::size_t, 3> cursors_{};
  std::array<std::array<const std::uint64_t*, 3>, 3> around_{};  // [slice][row]
  std::vector<std::uint64_t> interior_;                          // [word] of the current run
};

void add_run(std::uint64_t scanline, std::int64_t begin, std::int64_t end, ClassRuns& runs) {
  if (begin < end)
    runs.push_back({scanline, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
}

}  // namespace

ClassRuns join_runs(std::span<const Run> a, std::span<const Run> b) {
  ClassRuns both(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), both.begin());
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
  TaskPace pace;
  for (std::size_t n = 0; n < runs.size();) {
    pace.step();
    const std::uint64_t scanline = runs[n].scanline;
    const bool may_be_interior = window.go_to(scanline);
    for (; n < runs.size() && runs[n].scanline == scanline; ++n) {
      std::int64_t at = runs[n].start;
      const std::int64_t stop = at + runs[n].length;
      if (may_be_interior) {
        window.for_each_interior(runs[n], [&](std::int64_t begin, std::int64_t end) {
          add_run(scanline, at, begin, split.boundary);
          add_run(scanline, begin, end, split.interior);
          at = end;
        });
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
  std::vector<std::size_t> holder;  // [structure]: its group, or kSeveral
  for (ClassId c = 0; c < table.size(); ++c) {
    for (const Membership& m : table.members(c)) {
      if (!m.holds()) continue;
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
