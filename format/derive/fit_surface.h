// The surface and the normals of a structure, from its voxels alone: files need not store what this gives.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "format/class_table.h"
#include "format/derive/smooth_gradient.h"
#include "format/derive/structure_crop.h"
#include "format/grid.h"
#include "format/run_model.h"
#include "format/surface.h"
#include "format/unit_vector.h"

namespace splatlas {

/// The normal of a boundary voxel: against the gradient of the structure's smoothed mask (see
/// SmoothGradient), brought into LPS.
class VoxelNormals {
 public:
  explicit VoxelNormals(const Grid& grid) : to_index_(lps_mm_to_index(grid).linear) {}
  /// `gradient` is per voxel along i, j, k.
  [[nodiscard]] PackedNormal normal(const std::array<float, 3>& gradient) const;
  /// Gradients go by the inverse's transpose.
  [[nodiscard]] std::array<float, 3> to_lps(const std::array<float, 3>& gradient) const;

 private:
  Matrix3 to_index_;
};

/// Sees a slice's gradients, slice by slice of the crop.
using SliceVisitor = std::function<void(const SmoothGradient& gradient, std::int64_t k)>;

/// Marching cubes on a whole structure's crop, with the normals of the smoothed mask: those of the voxels at
/// either end of each vertex' edge, added; the triangles' own where those point inwards. Normals are as files
/// keep them, unpack_normal(pack_normal(n)): so the same comes back from a file that stores the surface.
/// `visit_slice` may be empty. Cost: linear in the crop's voxels.
[[nodiscard]] SurfaceMesh fit_surface(const StructureCrop& crop, const Grid& grid,
                                      const SliceVisitor& visit_slice = {});

/// The part of a structure that the normals of voxels in `box` depend on: to be painted.
[[nodiscard]] StructureCrop empty_crop_around(const IndexBox& box);
/// Normals of the voxels of `runs` (of principal axis z), in memory order. `crop` is painted, and made by
/// empty_crop_around() of a box that holds them all.
[[nodiscard]] std::vector<PackedNormal> fit_normals(const StructureCrop& crop, std::span<const Run> runs,
                                                    const Grid& grid);

/// The structure whose normal a class's voxels take: the first of which they are boundary; else kNoStructure.
[[nodiscard]] StructureIndex normal_owner(std::span<const Membership> members);
/// [class]: normal_owner() of its members.
[[nodiscard]] std::vector<StructureIndex> normal_owners(const ClassTable& classes);

}  // namespace splatlas
