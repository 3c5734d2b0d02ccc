// The Rendering Decision Tree: the structure graph with the classes as its (shared) leaves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/class_table.h"
#include "format/selection.h"
#include "format/structure_graph.h"

namespace splatlas {

/// What a selection draws of a class's voxels (the paper's categories, section 3).
enum class VoxelRole : std::uint8_t { kNone, kVolume, kSurface, kHybrid };

/// Whether voxels contribute to the volume.
[[nodiscard]] constexpr bool draws_volume(VoxelRole role) {
  return role == VoxelRole::kVolume || role == VoxelRole::kHybrid;
}

/// What to draw for one class. For volume and hybrid voxels `volume_of` gives colour and opacity; for surface
/// and hybrid voxels the surfaces that cross them are those of every selected structure with a boundary here.
struct ClassDraw {
  ClassId id = kEmptyClass;
  VoxelRole role = VoxelRole::kNone;
  StructureIndex volume_of = kNoStructure;  ///< the structure whose look the volume takes
  bool boundary = false;                    ///< of `volume_of`: shaded by its normal (hybrid shading)
  friend bool operator==(const ClassDraw&, const ClassDraw&) = default;
};

/// What a selection comes to: classes to traverse and surfaces to rasterise, nothing else.
struct DrawPlan {
  std::vector<ClassDraw> classes;  ///< role != kNone only, in class order
  /// Structures with boundary classes that are selected as surface or both, in index order; external ones in
  /// any mode.
  std::vector<StructureIndex> surfaces;
  std::uint64_t volume_voxels = 0;   ///< k_vol
  std::uint64_t surface_voxels = 0;  ///< k_sur
  std::uint64_t hybrid_voxels = 0;   ///< k_hyb
};

/// Structures lead to classes; classes that several structures share are leaves of each of them.
/// Immutable; safe to share between threads. Holds references: graph and classes must outlive it.
class DecisionTree {
 public:
  DecisionTree(const StructureGraph& graph, const ClassTable& classes);

  /// Classes whose voxels are interior to `s` itself (not to its descendants).
  [[nodiscard]] std::span<const ClassId> interior_classes(StructureIndex s) const;
  /// Classes whose voxels are boundary of `s` itself, or are crossed by its external surface.
  [[nodiscard]] std::span<const ClassId> boundary_classes(StructureIndex s) const;

  /// Walks the tree once for a selection, structure by structure:
  ///   volume   interior and boundary voxels are drawn as volume
  ///   surface  boundary voxels are drawn as surface
  ///   both     interior voxels as volume, boundary voxels as hybrid
  /// Voxels that are only crossed by an external surface are drawn as surface in every mode: it holds no
  /// volume. A class that is volume for one selected structure and surface for another is hybrid. Where
  /// several selected structures hold a voxel, the one selected by the latest term gives the look; within a
  /// term the one with the higher index (the more specific one). `selection` is one of this graph (or an
  /// empty one). Cost: linear in the selected structures' leaves and the number of structures and classes.
  [[nodiscard]] DrawPlan plan(const Selection& selection) const;

  /// Voxels below `s`, each counted once: boundary where it is boundary of any descendant, else interior.
  /// Voxels only crossed by external surfaces count as boundary of those.
  struct VoxelCounts {
    std::uint64_t interior = 0, boundary = 0;
  };
  /// Cost: linear in the leaves below `s`, times the logarithm of that.
  [[nodiscard]] VoxelCounts voxel_counts(StructureIndex s) const;

 private:
  const StructureGraph& graph_;
  const ClassTable& classes_;
  std::vector<std::uint32_t> first_interior_, first_boundary_;  // size + 1 offsets
  std::vector<ClassId> interior_, boundary_;
  std::vector<bool> crossed_;  // per entry of boundary_: only crossed, not held
};

}  // namespace splatlas
