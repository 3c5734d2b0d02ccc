#include "bench/experiments/class_models.h"

#include <bit>

#include "format/result_macros.h"

namespace splatlas {

void RunCollector::start(const Index3& size, Axis axis) {
  for (std::size_t slice = 0; slice < used_.size(); ++slice) {
    for (std::size_t row = used_[slice].first; row < used_[slice].last; ++row)
      lines_[slice * rows_ + row].clear();
  }
  scan_ = ScanOrder::of(axis);
  rows_ = static_cast<std::size_t>(size[scan_.row_axis]);
  used_.assign(static_cast<std::size_t>(size[scan_.slice_axis]), {static_cast<std::uint32_t>(rows_), 0});
  lines_.resize(used_.size() * rows_);
}

void RunCollector::add_list(std::span<const Run> runs, std::uint32_t draw) {
  for (const Run& run : runs) {
    add(run.scanline / rows_,
        {static_cast<std::uint32_t>(run.scanline % rows_), run.start, run.length, draw});
  }
}

std::span<const WalkedRun> RunCollector::sorted(std::vector<WalkedRun>& line) {
  if (line.empty()) return line;
  if (!std::ranges::is_sorted(line, {}, &WalkedRun::start)) std::ranges::sort(line, {}, &WalkedRun::start);
  std::size_t last = 0;
  for (std::size_t n = 1; n < line.size(); ++n) {
    const std::uint32_t end = line[last].start + line[last].length;
    if (line[n].draw == line[last].draw && line[n].start < end) {
      line[last].length = std::max(end, line[n].start + line[n].length) - line[last].start;
    } else {
      line[++last] = line[n];
    }
  }
  line.resize(last + 1);
  return line;
}

namespace {

/// The classes with voxels of `s` or a descendant.
std::vector<ClassId> held_below(const StructureGraph& graph, const ClassTable& classes, StructureIndex s) {
  std::vector<bool> below(graph.size(), false);
  for (const StructureIndex d : graph.descendants(s)) below[d] = true;
  std::vector<ClassId> held;
  for (ClassId c = 0; c < classes.size(); ++c) {
    if (std::ranges::any_of(classes.members(c),
                            [&](const Membership& m) { return below[m.structure] && m.holds(); }))
      held.push_back(c);
  }
  return held;
}

/// The union of the runs of several classes.
ClassRuns united(std::span<const ClassId> classes, const std::vector<ClassRuns>& of_class) {
  ClassRuns runs;
  for (const ClassId c : classes) runs.insert(runs.end(), of_class[c].begin(), of_class[c].end());
  std::sort(runs.begin(), runs.end());
  ClassRuns whole;
  for (const Run& run : runs) {
    if (!whole.empty() && whole.back().scanline == run.scanline &&
        whole.back().start + whole.back().length == run.start) {
      whole.back().length += run.length;
    } else {
      whole.push_back(run);
    }
  }
  return whole;
}

}  // namespace

Result<LevelRuns> LevelRuns::build(const Atlas& atlas) {
  const StructureGraph& graph = atlas.graph();
  LevelRuns levels;
  levels.topological_.assign(graph.topological().begin(), graph.topological().end());
  for (StructureIndex s = 0; s < graph.size(); ++s)
    levels.classes_below_.push_back(held_below(graph, atlas.classes(), s));
  for (const Axis axis : kAxes) {
    const auto a = static_cast<std::size_t>(axis);
    for (ClassId c = 0; c < atlas.classes().size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(levels.of_class_[a].emplace_back(), atlas.read_runs(c, axis));
    }
    for (const std::vector<ClassId>& below : levels.classes_below_)
      levels.of_structure_[a].push_back(united(below, levels.of_class_[a]));
  }
  return levels;
}

void LevelRuns::collect(std::span<const std::uint32_t> draw_of_class, Axis axis, RunCollector& runs) const {
  const auto a = static_cast<std::size_t>(axis);
  std::vector<bool> covered(draw_of_class.size(), false);
  for (const StructureIndex s : topological_) {
    const std::vector<ClassId>& below = classes_below_[s];
    if (below.empty()) continue;
    const std::uint32_t draw = draw_of_class[below[0]];
    if (draw == kNotDrawn ||
        !std::ranges::all_of(below, [&](ClassId c) { return draw_of_class[c] == draw; }) ||
        std::ranges::all_of(below, [&](ClassId c) { return covered[c]; }))
      continue;
    for (const ClassId c : below) covered[c] = true;
    runs.add_list(of_structure_[a][s], draw);
  }
  for (ClassId c = 0; c < draw_of_class.size(); ++c) {
    if (draw_of_class[c] != kNotDrawn && !covered[c]) runs.add_list(of_class_[a][c], draw_of_class[c]);
  }
}

namespace {

constexpr std::int64_t kBrick = 8;

Index3 corner_of(const Index3& corner, std::int64_t half, unsigned child) {
  return {corner[0] + (child & 1u ? half : 0), corner[1] + (child & 2u ? half : 0),
          corner[2] + (child & 4u ? half : 0)};
}

}  // namespace

ClassOctree::Node ClassOctree::build(const Index3& corner, std::int64_t side) const {
  if (corner[0] >= size_[0] || corner[1] >= size_[1] || corner[2] >= size_[2]) return {{kEmptyClass}, {}};
  Node node;
  if (side == kBrick) {
    for (std::int64_t k = corner[2]; k < std::min(corner[2] + side, size_[2]); ++k) {
      for (std::int64_t j = corner[1]; j < std::min(corner[1] + side, size_[1]); ++j) {
        for (std::int64_t i = corner[0]; i < std::min(corner[0] + side, size_[0]); ++i)
          node.classes.push_back(volume_[static_cast<std::size_t>((k * size_[1] + j) * size_[0] + i)]);
      }
    }
  } else {
    for (unsigned n = 0; n < 8; ++n) {
      const Node& child = node.children.emplace_back(build(corner_of(corner, side / 2, n), side / 2));
      node.classes.insert(node.classes.end(), child.classes.begin(), child.classes.end());
    }
  }
  std::sort(node.classes.begin(), node.classes.end());
  node.classes.erase(std::unique(node.classes.begin(), node.classes.end()), node.classes.end());
  if (node.classes.size() == 1) node.children.clear();
  return node;
}

/// Traversal for one selection.
struct ClassOctree::Walk {
  const ClassOctree& tree;
  std::span<const std::uint32_t> draws;  ///< per class
  RunCollector& runs;

  void visit(const Node& node, const Index3& corner, std::int64_t side) {
    const std::uint32_t draw = draws[node.classes[0]];
    const bool alike = std::ranges::all_of(node.classes, [&](ClassId c) { return draws[c] == draw; });
    if (alike && draw == kNotDrawn) return;
    if (alike || side == kBrick) return visit_cube(corner, side, alike);
    const ScanOrder& scan = runs.scan();
    // Order: slice, row, then position, so that each scanline gets sorted runs.
    for (unsigned n = 0; n < 8; ++n) {
      const unsigned child =
          (n >> 2u & 1u) << scan.slice_axis | (n >> 1u & 1u) << scan.row_axis | (n & 1u) << scan.scan_axis;
      visit(node.children[child], corner_of(corner, side / 2, child), side / 2);
    }
  }

  /// Adds the scanlines of a cube with one draw, or of a mixed brick.
  void visit_cube(const Index3& corner, std::int64_t side, bool alike) {
    const auto& [row_axis, slice_axis, scan_axis] =
        std::array{runs.scan().row_axis, runs.scan().slice_axis, runs.scan().scan_axis};
    const auto end = [&](std::size_t axis) { return std::min(corner[axis] + side, tree.size_[axis]); };
    const Index3 step{1, tree.size_[0], tree.size_[0] * tree.size_[1]};
    for (std::int64_t slice = corner[slice_axis]; slice < end(slice_axis); ++slice) {
      for (std::int64_t row = corner[row_axis]; row < end(row_axis); ++row) {
        const ClassId* const line = tree.volume_.data() + slice * step[slice_axis] + row * step[row_axis];
        for (std::int64_t n = corner[scan_axis]; n < end(scan_axis);) {
          const std::int64_t first = n;
          const std::uint32_t draw = draws[line[n * step[scan_axis]]];
          if (alike) n = end(scan_axis) - 1;
          do ++n;
          while (n < end(scan_axis) && draws[line[n * step[scan_axis]]] == draw);
          if (draw == kNotDrawn) continue;
          runs.add(static_cast<std::size_t>(slice),
                   {static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(n - first), draw});
        }
      }
    }
  }
};

ClassOctree::ClassOctree(std::span<const ClassId> volume, const Index3& size)
    : volume_(volume),
      size_(size),
      side_(static_cast<std::int64_t>(
          std::bit_ceil(static_cast<std::uint64_t>(*std::ranges::max_element(size))))),
      root_(build({0, 0, 0}, side_)) {}

void ClassOctree::collect(std::span<const std::uint32_t> draw_of_class, RunCollector& runs) const {
  Walk{*this, draw_of_class, runs}.visit(root_, {0, 0, 0}, side_);
}

}  // namespace splatlas
