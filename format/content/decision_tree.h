// Rendering decision tree: the structure graph with the voxel classes as its shared leaves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/selection.h"
#include "format/content/structure_graph.h"

namespace splatlas {

/// Rendering category of the voxels of a class (WSCG 2004, section 3; see ClassId).
enum class VoxelRole : std::uint8_t { kNone, kVolume, kSurface, kHybrid };

/// True if voxels of this role contribute to the volume.
[[nodiscard]] constexpr bool draws_volume(VoxelRole role) {
  return role == VoxelRole::kVolume || role == VoxelRole::kHybrid;
}

/// Drawing of a class. Surface and hybrid voxels hold the surface of every selected structure bounded there.
struct ClassDraw {
  ClassId id = kEmptyClass;
  VoxelRole role = VoxelRole::kNone;
  StructureIndex volume_of = kNoStructure;  ///< structure with the appearance of the volume
  bool boundary = false;  ///< boundary of `volume_of`: shaded by the normal (hybrid shading)
  friend bool operator==(const ClassDraw&, const ClassDraw&) = default;
};

/// Classes to traverse and surfaces to rasterise for one selection.
struct DrawPlan {
  std::vector<ClassDraw> classes;  ///< classes with role != kNone, in class order
  /// Structures with boundary classes selected as surface or both, in index order; external ones in any mode.
  std::vector<StructureIndex> surfaces;
  std::uint64_t volume_voxels = 0;   ///< k_vol
  std::uint64_t surface_voxels = 0;  ///< k_sur
  std::uint64_t hybrid_voxels = 0;   ///< k_hyb
};

/// Maps structures to classes. A class shared by several structures is a leaf of each of them. Immutable and
/// thread-safe. Keeps references: graph and classes must outlive it.
class DecisionTree {
 public:
  DecisionTree(const StructureGraph& graph, const ClassTable& classes);

  /// Classes in the interior of `s` itself, without its descendants.
  [[nodiscard]] std::span<const ClassId> interior_classes(StructureIndex s) const;
  /// Classes on the boundary of `s` itself, or crossed by its external surface.
  [[nodiscard]] std::span<const ClassId> boundary_classes(StructureIndex s) const;

  /// Traverses the tree once and assigns roles, structure by structure:
  ///   volume   interior and boundary voxels are drawn as volume
  ///   surface  boundary voxels are drawn as surface
  ///   both     interior voxels as volume, boundary voxels as hybrid
  /// Voxels that are only crossed by an external surface are drawn as surface in every mode. A class that is
  /// volume for one selected structure and surface for another is hybrid. If several selected structures
  /// contain a voxel, the one of the latest term determines the appearance; within a term, the one with the
  /// higher index (the more specific one). Entries beyond the graph are ignored. Cost: linear in
  /// the leaves of the selected structures and in the number of structures and classes.
  [[nodiscard]] DrawPlan plan(const Selection& selection) const;

 private:
  const StructureGraph& graph_;
  const ClassTable& classes_;
  std::vector<std::uint32_t> first_interior_, first_boundary_;  // size + 1 offsets
  std::vector<ClassId> interior_, boundary_;
  std::vector<bool> crossed_;  // per entry of boundary_: true for Part::kCrossed
};

/// Counts of a structure and its descendants, each descendant and each class counted once. A class counts as
/// boundary if it is on the boundary of any of them or crossed by their surface, else as interior.
struct SubtreeCounts {
  std::uint64_t interior = 0, boundary = 0;  ///< voxels
  std::uint64_t triangles = 0;
  friend bool operator==(const SubtreeCounts&, const SubtreeCounts&) = default;
};

/// [structure]: its counts, for all structures at once. `tree` is that of graph and classes; `triangles` has
/// one entry per structure. Sixty-four structures share one traversal of their descendants. Cost in a graph
/// of s structures and e parents: at most s / 64 * (s + e), and one step per pair of a structure and a class
/// or structure below it.
[[nodiscard]] std::vector<SubtreeCounts> subtree_counts(const StructureGraph& graph,
                                                        const ClassTable& classes, const DecisionTree& tree,
                                                        std::span<const std::uint64_t> triangles);

}  // namespace splatlas
