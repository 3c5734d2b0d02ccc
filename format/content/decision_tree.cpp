#include "format/content/decision_tree.h"

#include <algorithm>
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

}  // namespace splatlas
