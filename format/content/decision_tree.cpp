#include "format/content/decision_tree.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

namespace splatlas {
namespace {

bool has_volume(DrawMode mode) {
  return mode == DrawMode::kVolume || mode == DrawMode::kBoth;
}
bool has_surface(DrawMode mode) {
  return mode == DrawMode::kSurface || mode == DrawMode::kBoth;
}

/// Draw requests for one class by the structures selected so far.
struct ClassDemand {
  bool volume = false;
  bool surface = false;
  StructureIndex volume_of = kNoStructure;
  bool boundary = false;
};

/// Adds the request of one selected structure for its voxels of one part.
void add_demand(const Selection& selection, StructureIndex s, Part part, ClassDemand& demand) {
  const DrawMode mode = selection.structures[s].mode;
  if (part == Part::kCrossed) {  // no interior: every mode draws the surface
    demand.surface = true;
    return;
  }
  if (part == Part::kBoundary && has_surface(mode)) demand.surface = true;
  if (!has_volume(mode)) return;
  const auto rank = [&](StructureIndex other) { return std::tuple(selection.structures[other].term, other); };
  if (!demand.volume || rank(s) > rank(demand.volume_of)) {
    demand.volume_of = s;
    demand.boundary = part == Part::kBoundary;
  }
  demand.volume = true;
}

VoxelRole role_of(const ClassDemand& demand) {
  if (demand.volume) return demand.surface ? VoxelRole::kHybrid : VoxelRole::kVolume;
  return demand.surface ? VoxelRole::kSurface : VoxelRole::kNone;
}

std::span<const ClassId> list_of(const std::vector<ClassId>& leaves, const std::vector<std::uint32_t>& first,
                                 StructureIndex s) {
  return std::span(leaves).subspan(first[s], first[s + 1] - first[s]);
}

constexpr std::size_t kBatch = 64;
using Mask = std::uint64_t;  // bit n: the n-th structure of the batch

/// Calls add(n) for the structures of a mask.
template <typename Add>
void for_each_bit(Mask mask, const Add& add) {
  for (; mask != 0; mask &= mask - 1) add(static_cast<std::size_t>(std::countr_zero(mask)));
}

/// Counts of up to 64 structures by one traversal of their descendants.
class BatchCounter {
 public:
  BatchCounter(const StructureGraph& graph, const ClassTable& classes, const DecisionTree& tree,
               std::span<const std::uint64_t> triangles)
      : graph_(graph),
        classes_(classes),
        tree_(tree),
        triangles_(triangles),
        rank_(graph.size()),
        above_(graph.size(), 0),
        inside_(classes.size(), 0),
        on_boundary_(classes.size(), 0) {
    const auto order = graph.topological();
    for (std::uint32_t n = 0; n < order.size(); ++n) rank_[order[n]] = n;
  }

  void count(std::span<const StructureIndex> batch, std::vector<SubtreeCounts>& counts) {
    const std::vector<StructureIndex> below = descend(batch);
    for (const StructureIndex s : below) {
      for_each_bit(above_[s], [&](std::size_t n) { counts[batch[n]].triangles += triangles_[s]; });
      for (const ClassId c : tree_.interior_classes(s)) mark(inside_, c, s);
      for (const ClassId c : tree_.boundary_classes(s)) mark(on_boundary_, c, s);
      above_[s] = 0;
    }
    for (const ClassId c : touched_) {
      const std::uint64_t voxels = classes_.voxels(c);
      for_each_bit(on_boundary_[c], [&](std::size_t n) { counts[batch[n]].boundary += voxels; });
      for_each_bit(inside_[c] & ~on_boundary_[c],
                   [&](std::size_t n) { counts[batch[n]].interior += voxels; });
      inside_[c] = on_boundary_[c] = 0;
    }
    touched_.clear();
  }

 private:
  void mark(std::vector<Mask>& masks, ClassId c, StructureIndex s) {
    if ((inside_[c] | on_boundary_[c]) == 0) touched_.push_back(c);
    masks[c] |= above_[s];
  }

  /// Sets above_ of all descendants, and returns them in topological order.
  std::vector<StructureIndex> descend(std::span<const StructureIndex> batch) {
    std::vector<StructureIndex> below = graph_.descendants(batch);
    std::ranges::sort(below, {}, [&](StructureIndex s) { return rank_[s]; });
    for (std::size_t n = 0; n < batch.size(); ++n) above_[batch[n]] |= Mask{1} << n;
    for (const StructureIndex s : below) {
      for (const StructureIndex child : graph_.children(s)) above_[child] |= above_[s];
    }
    return below;
  }

  const StructureGraph& graph_;
  const ClassTable& classes_;
  const DecisionTree& tree_;
  std::span<const std::uint64_t> triangles_;
  std::vector<std::uint32_t> rank_;         // [structure]: in topological order
  std::vector<Mask> above_;                 // [structure]: structures of the batch that contain it
  std::vector<Mask> inside_, on_boundary_;  // [class]
  std::vector<ClassId> touched_;
};

}  // namespace

DecisionTree::DecisionTree(const StructureGraph& graph, const ClassTable& classes)
    : graph_(graph), classes_(classes), first_interior_(graph.size() + 1), first_boundary_(graph.size() + 1) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      ++(m.part == Part::kInterior ? first_interior_ : first_boundary_)[m.structure + 1];
    }
  }
  std::partial_sum(first_interior_.begin(), first_interior_.end(), first_interior_.begin());
  std::partial_sum(first_boundary_.begin(), first_boundary_.end(), first_boundary_.begin());
  interior_.resize(first_interior_.back());
  boundary_.resize(first_boundary_.back());
  crossed_.resize(first_boundary_.back());
  auto next_interior = first_interior_;
  auto next_boundary = first_boundary_;
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.part == Part::kInterior) {
        interior_[next_interior[m.structure]++] = c;
      } else {
        crossed_[next_boundary[m.structure]] = m.part == Part::kCrossed;
        boundary_[next_boundary[m.structure]++] = c;
      }
    }
  }
}

std::span<const ClassId> DecisionTree::interior_classes(StructureIndex s) const {
  return list_of(interior_, first_interior_, s);
}

std::span<const ClassId> DecisionTree::boundary_classes(StructureIndex s) const {
  return list_of(boundary_, first_boundary_, s);
}

DrawPlan DecisionTree::plan(const Selection& selection) const {
  DrawPlan plan;
  std::vector<ClassDemand> demands(classes_.size());
  const std::size_t structures = std::min(selection.structures.size(), graph_.size());
  for (StructureIndex s = 0; s < structures; ++s) {
    const DrawMode mode = selection.structures[s].mode;
    if (mode == DrawMode::kOff) continue;
    if (has_volume(mode)) {
      for (const ClassId c : interior_classes(s)) add_demand(selection, s, Part::kInterior, demands[c]);
    }
    for (std::uint32_t n = first_boundary_[s]; n < first_boundary_[s + 1]; ++n) {
      add_demand(selection, s, crossed_[n] ? Part::kCrossed : Part::kBoundary, demands[boundary_[n]]);
    }
    const bool draws_surface = has_surface(mode) || graph_[s].external;
    if (draws_surface && !boundary_classes(s).empty()) plan.surfaces.push_back(s);
  }
  for (ClassId c = 0; c < demands.size(); ++c) {
    const VoxelRole role = role_of(demands[c]);
    if (role == VoxelRole::kNone) continue;
    plan.classes.push_back({c, role, demands[c].volume_of, demands[c].boundary});
    if (role == VoxelRole::kVolume) plan.volume_voxels += classes_.voxels(c);
    if (role == VoxelRole::kSurface) plan.surface_voxels += classes_.voxels(c);
    if (role == VoxelRole::kHybrid) plan.hybrid_voxels += classes_.voxels(c);
  }
  return plan;
}

std::vector<SubtreeCounts> subtree_counts(const StructureGraph& graph, const ClassTable& classes,
                                          const DecisionTree& tree,
                                          std::span<const std::uint64_t> triangles) {
  std::vector<SubtreeCounts> counts(graph.size());
  BatchCounter counter(graph, classes, tree, triangles);
  const auto order = graph.preorder();  // neighbours share most descendants
  for (std::size_t first = 0; first < order.size(); first += kBatch)
    counter.count(order.subspan(first, std::min(kBatch, order.size() - first)), counts);
  return counts;
}

}  // namespace splatlas
