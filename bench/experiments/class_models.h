// Models other than the run model (paper, sections 3 and 5): run models per level of the tree, and an octree.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/experiments/walked_spans.h"
#include "format/atlas_reader.h"

namespace splatlas {

/// Runs of a selection, by slice, row and start.
class RunCollector {
 public:
  /// Starts anew, with the memory of earlier runs.
  void start(const Index3& size, Axis axis);
  [[nodiscard]] const ScanOrder& scan() const { return scan_; }
  /// Runs of different draws never overlap; those of one draw may.
  void add(std::size_t slice, const WalkedRun& run) {
    lines_[slice * rows_ + run.row].push_back(run);
    used_[slice] = {std::min(used_[slice].first, run.row), std::max(used_[slice].last, run.row + 1)};
  }
  void add_list(std::span<const Run> runs, std::uint32_t draw);
  /// Calls take(run) for the runs of a slice, sorted.
  template <typename Take>
  void for_each(std::int64_t slice, const Take& take) {
    const auto n = static_cast<std::size_t>(slice);
    for (std::size_t row = used_[n].first; row < used_[n].last; ++row) {
      for (const WalkedRun& run : sorted(lines_[n * rows_ + row])) take(run);
    }
  }

 private:
  /// Sorts the runs of a scanline, and merges overlapping ones.
  static std::span<const WalkedRun> sorted(std::vector<WalkedRun>& line);

  ScanOrder scan_;
  std::size_t rows_ = 1;
  std::vector<std::vector<WalkedRun>> lines_;  // per scanline
  struct Rows {
    std::uint32_t first = 0, last = 0;  // the end
  };
  std::vector<Rows> used_;  // per slice
};

/// For every structure, the runs of its voxels and those of its descendants, along each axis. The lists of
/// classes are the lowest level. Immutable.
class LevelRuns {
 public:
  /// Reads the runs of every class. Cost: each run once per structure above it, sorted.
  [[nodiscard]] static Result<LevelRuns> build(const Atlas& atlas);
  /// Adds the runs of every class with a draw: from the lists of the highest structures with a single draw,
  /// and of single classes elsewhere.
  void collect(std::span<const std::uint32_t> draw_of_class, Axis axis, RunCollector& runs) const;

 private:
  std::vector<StructureIndex> topological_;
  std::vector<std::vector<ClassId>> classes_below_;                // per structure, ascending
  std::array<std::vector<ClassRuns>, 3> of_class_, of_structure_;  // per axis
};

/// Cubes of voxels, divided until one class fills a node, or down to bricks of 8 x 8 x 8 voxels. Every node
/// knows the set of its classes. One tree serves all axes. Immutable.
class ClassOctree {
 public:
  /// `volume` has `size` voxels, i fastest, and must outlive this.
  ClassOctree(std::span<const ClassId> volume, const Index3& size);
  /// Adds the runs of every class with a draw. Skips nodes without; fills nodes with a single draw.
  void collect(std::span<const std::uint32_t> draw_of_class, RunCollector& runs) const;

 private:
  struct Node {
    std::vector<ClassId> classes;  // ascending
    std::vector<Node> children;    // none or eight: bit a of child n selects the upper half of axis a
  };
  struct Walk;
  [[nodiscard]] Node build(const Index3& corner, std::int64_t side) const;

  std::span<const ClassId> volume_;
  Index3 size_;
  std::int64_t side_;  // of the root, in voxels
  Node root_;
};

}  // namespace splatlas
