#include "bench/experiments/level_runs.h"

#include <algorithm>
#include <utility>

#include "format/codec/run_codec.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// The classes with voxels of `s` or a descendant.
std::vector<ClassId> held_below(const StructureGraph& graph, const ClassTable& classes, StructureIndex s) {
  std::vector<bool> below(graph.size(), false);
  for (const StructureIndex d : graph.descendants(s)) below[d] = true;
  std::vector<ClassId> held;
  for (ClassId c = 0; c < classes.size(); ++c) {
    const auto members = classes.members(c);
    if (std::any_of(members.begin(), members.end(), [&](const Membership& member) {
          return below[member.structure] && member.part != Part::kCrossed;
        })) {
      held.push_back(c);
    }
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
  levels.size_ = atlas.grid().size;
  levels.topological_.assign(graph.topological().begin(), graph.topological().end());
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    levels.classes_below_.push_back(held_below(graph, atlas.classes(), s));
  }
  for (const Axis axis : kAxes) {
    auto& of_class = levels.of_class_[static_cast<std::size_t>(axis)];
    for (ClassId c = 0; c < atlas.classes().size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(ClassRuns runs, atlas.read_runs(c, axis));
      of_class.push_back(std::move(runs));
    }
    for (const std::vector<ClassId>& below : levels.classes_below_) {
      levels.of_structure_[static_cast<std::size_t>(axis)].push_back(united(below, of_class));
    }
  }
  return levels;
}

LevelRuns::Cover LevelRuns::cover(std::span<const std::uint32_t> draw_of_class) const {
  Cover cover;
  std::vector<bool> covered(draw_of_class.size(), false);
  for (const StructureIndex s : topological_) {
    const std::vector<ClassId>& below = classes_below_[s];
    if (below.empty()) continue;
    const std::uint32_t draw = draw_of_class[below[0]];
    const bool alike = draw != kNotDrawn && std::all_of(below.begin(), below.end(),
                                                        [&](ClassId c) { return draw_of_class[c] == draw; });
    if (!alike) continue;
    if (std::all_of(below.begin(), below.end(), [&](ClassId c) { return covered[c]; })) continue;
    for (const ClassId c : below) covered[c] = true;
    cover.structures.emplace_back(s, draw);
  }
  for (ClassId c = 0; c < draw_of_class.size(); ++c) {
    if (draw_of_class[c] != kNotDrawn && !covered[c]) cover.classes.push_back(c);
  }
  return cover;
}

void LevelRuns::collect(std::span<const std::uint32_t> draw_of_class, Axis axis, RunCollector& runs) const {
  const Cover chosen = cover(draw_of_class);
  const auto a = static_cast<std::size_t>(axis);
  for (const auto& [structure, draw] : chosen.structures)
    runs.add_list(of_structure_[a][structure], size_, draw);
  for (const ClassId c : chosen.classes) runs.add_list(of_class_[a][c], size_, draw_of_class[c]);
}

std::uint64_t LevelRuns::runs(Axis axis) const {
  const auto a = static_cast<std::size_t>(axis);
  std::uint64_t runs = 0;
  for (const ClassRuns& list : of_class_[a]) runs += list.size();
  for (const ClassRuns& list : of_structure_[a]) runs += list.size();
  return runs;
}

std::vector<std::byte> LevelRuns::encoded(Axis axis) const {
  const auto a = static_cast<std::size_t>(axis);
  std::vector<std::byte> bytes;
  for (const ClassRuns& list : of_class_[a]) append_run_list(list, bytes);
  for (const ClassRuns& list : of_structure_[a]) append_run_list(list, bytes);
  return bytes;
}

}  // namespace splatlas
