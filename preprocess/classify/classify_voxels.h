// Classification of voxels by their structures, boundaries and crossing surfaces.
#pragma once

#include <cstdint>
#include <span>

#include "format/content/class_table.h"
#include "format/content/run_model.h"
#include "preprocess/import/membership_volume.h"

namespace splatlas {

/// A voxel crossed by the external surface of a structure.
struct CrossedVoxel {
  std::int64_t voxel = 0;  ///< memory offset
  StructureIndex structure = kNoStructure;
  friend auto operator<=>(const CrossedVoxel&, const CrossedVoxel&) = default;
};

struct ClassifiedVoxels {
  ClassTable classes;  ///< with counts and boxes, in storage_order()
  RunModel runs;       ///< along z
};

/// Determines the class of every voxel (WSCG 2004, section 3; see ClassId). A voxel is boundary of a
/// structure if one of its 18 neighbours (sharing a face or an edge) is outside the structure or beyond the
/// grid. `memberships` must use the indices of `graph`; `crossed` must be sorted and unique. kLimit if more
/// than 64 structures contain one voxel. Cost: two passes with 18 vectorized comparisons per voxel. Memory:
/// that of `memberships`, reused, and of 32 slices. The same for all `threads` (0: one per core).
[[nodiscard]] Result<ClassifiedVoxels> classify_voxels(MembershipVolume memberships,
                                                       std::span<const CrossedVoxel> crossed,
                                                       const StructureGraph& graph, unsigned threads = 0);

}  // namespace splatlas
