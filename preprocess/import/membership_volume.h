// Volume of structure sets per voxel.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "preprocess/import/widen_grid.h"

namespace splatlas {

/// The set of structures that contain each voxel. There are few distinct sets, so that voxels store set ids.
/// Label maps have sets of at most one structure.
class MembershipVolume {
 public:
  using SetId = std::uint32_t;  ///< 0 is the empty set

  /// All sets are empty.
  explicit MembershipVolume(const Index3& size);
  /// `sets[n]` is set n, sorted and unique. All sets must differ, and sets[0] must be empty.
  MembershipVolume(const Index3& size, std::vector<std::vector<StructureIndex>> sets,
                   std::vector<SetId> voxels);

  [[nodiscard]] const Index3& size() const { return size_; }
  [[nodiscard]] std::span<const SetId> voxels() const { return voxels_; }  ///< i fastest
  [[nodiscard]] std::span<const std::vector<StructureIndex>> sets() const { return sets_; }
  /// True if no voxel is in two structures.
  [[nodiscard]] bool disjoint() const;

  /// Adds `structure` to the sets of all voxels with non-zero `mask`. Returns their number. Cost: one pass.
  std::uint64_t add(StructureIndex structure, std::span<const std::uint8_t> mask);
  /// Adds to every voxel its structure, none for kNoStructure. Cost: one pass.
  void add_each(std::span<const StructureIndex> structures);
  /// Adds empty voxels around.
  void widen(const Margin& margin);
  /// Removes `structure` from the sets of `count` voxels from `first` on, which must contain it.
  void remove(StructureIndex structure, std::size_t first, std::size_t count);
  /// Replaces structure n by `new_numbers[n]`. Cost: linear in the sets.
  void renumber(std::span<const StructureIndex> new_numbers);

 private:
  SetId intern(std::vector<StructureIndex> set);

  Index3 size_;
  std::vector<std::vector<StructureIndex>> sets_;
  std::vector<SetId> voxels_;
  std::map<std::vector<StructureIndex>, SetId> index_;
};

}  // namespace splatlas
