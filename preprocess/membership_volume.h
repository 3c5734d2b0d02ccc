// Which structures hold each voxel.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/structure_graph.h"

namespace splatlas {

/// A set of structures per voxel. Label maps give sets of one structure, masks any; there are few distinct
/// sets, so a voxel stores a set's number.
class MembershipVolume {
 public:
  using SetId = std::uint32_t;  ///< 0 is the empty set

  /// No structure holds any voxel.
  explicit MembershipVolume(const Index3& size);
  /// `sets[n]` (sorted, without repeats) is set n; sets[0] must be empty, and all must differ.
  MembershipVolume(const Index3& size, std::vector<std::vector<StructureIndex>> sets,
                   std::vector<SetId> voxels);

  [[nodiscard]] const Index3& size() const { return size_; }
  [[nodiscard]] std::span<const SetId> voxels() const { return voxels_; }  ///< i fastest
  [[nodiscard]] std::span<const std::vector<StructureIndex>> sets() const { return sets_; }
  /// Whether no voxel is held by two structures.
  [[nodiscard]] bool disjoint() const;

  /// `structure` holds every voxel whose `mask` is not 0 as well. Returns how many. Cost: one pass.
  std::uint64_t add(StructureIndex structure, std::span<const std::uint8_t> mask);
  /// Structure n becomes `new_numbers[n]`. Cost: linear in the sets.
  void renumber(std::span<const StructureIndex> new_numbers);

 private:
  SetId intern(std::vector<StructureIndex> set);

  Index3 size_;
  std::vector<std::vector<StructureIndex>> sets_;
  std::vector<SetId> voxels_;
  std::map<std::vector<StructureIndex>, SetId> index_;
};

}  // namespace splatlas
