// Memberships become classes: the distinct combinations of structures and of how voxels belong to them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/class_table.h"
#include "preprocess/membership_volume.h"

namespace splatlas {

/// A voxel that the external surface of a structure crosses.
struct CrossedVoxel {
  std::int64_t voxel = 0;  ///< offset in memory
  StructureIndex structure = kNoStructure;
  friend auto operator<=>(const CrossedVoxel&, const CrossedVoxel&) = default;
};

struct Classification {
  ClassTable classes;           ///< counted, in storage_order
  std::vector<ClassId> volume;  ///< class per voxel, i fastest
};

/// Finds every voxel's class (paper, section 3, figure 3). For each structure that holds it, a voxel is
/// boundary when one of its 18 neighbours (sharing a face or an edge) is not held by that structure or is
/// beyond the grid. `memberships` are numbered as in `graph`; `crossed` is sorted, without repeats. kLimit
/// when more than 64 structures hold one voxel. Cost: two passes; 18 vectorised comparisons a voxel. The
/// result does not depend on `threads` (0: all cores).
[[nodiscard]] Result<Classification> classify_voxels(const MembershipVolume& memberships,
                                                     std::span<const CrossedVoxel> crossed,
                                                     const StructureGraph& graph, unsigned threads = 0);

}  // namespace splatlas
