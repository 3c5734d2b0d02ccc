// Voxel classes: the distinct combinations of structures and surfaces at a voxel.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/structure_graph.h"

namespace splatlas {

/// Classes partition the voxels, so that one run model serves every selection ("Using a classification tree
/// to speed up rendering of hybrid surface and volume models", WSCG 2004, section 3).
using ClassId = std::uint32_t;
inline constexpr ClassId kEmptyClass = 0;  ///< voxels outside all structures and surfaces

/// Relation of a voxel to a structure. Neighbourhoods have 18 voxels; voxels beyond the grid are outside.
enum class Part : std::uint8_t {
  kInterior = 0,  ///< inside, with all 18 neighbours inside
  kBoundary = 1,  ///< inside, with at least one of the 18 neighbours outside
  kCrossed = 2,   ///< outside, but crossed by the structure's external surface
};

/// A structure at a voxel. holds(): the voxel is inside the structure, not only crossed by its surface.
struct Membership {
  StructureIndex structure = kNoStructure;
  Part part = Part::kInterior;
  friend auto operator<=>(const Membership&, const Membership&) = default;
  [[nodiscard]] bool holds() const { return part != Part::kCrossed; }
};

/// Axis-aligned box of voxels from `first` to `last` inclusive; empty if first > last.
struct IndexBox {
  Index3 first{0, 0, 0};
  Index3 last{-1, -1, -1};
  friend bool operator==(const IndexBox&, const IndexBox&) = default;
  [[nodiscard]] bool empty() const { return first[0] > last[0]; }
  [[nodiscard]] std::uint64_t voxels() const;
  void include(const IndexBox& other);
};

/// True if the boxes have a voxel in common.
[[nodiscard]] bool overlap(const IndexBox& a, const IndexBox& b);

/// Memberships (sorted by structure), voxel count and bounding box of every class. 0: the empty class.
class ClassTable {
 public:
  ClassTable();

  /// Returns the class of a combination and creates it if it is new. `members` may be unsorted. Duplicate
  /// structures are merged, to kBoundary if their parts differ. Cost: logarithmic in the number of classes.
  ClassId intern(std::vector<Membership> members);
  /// Adds voxels to the count and the bounding box of a class.
  void count(ClassId c, std::uint64_t voxels, const IndexBox& box);

  [[nodiscard]] std::size_t size() const { return voxels_.size(); }
  [[nodiscard]] std::span<const Membership> members(ClassId c) const;
  [[nodiscard]] std::uint64_t voxels(ClassId c) const { return voxels_[c]; }
  [[nodiscard]] const IndexBox& box(ClassId c) const { return boxes_[c]; }

  /// The table with permuted classes: new class n is old class `order[n]`; order[0] must be 0.
  [[nodiscard]] ClassTable renumbered(std::span<const ClassId> order) const;

 private:
  std::vector<Membership> members_;
  std::vector<std::uint32_t> first_member_;  // size + 1 offsets into members_
  std::vector<std::uint64_t> voxels_;
  std::vector<IndexBox> boxes_;
  std::map<std::vector<Membership>, ClassId> index_;
};

/// Class ids in the storage order of their streams: lexicographic by (preorder rank of the structure, part)
/// of their memberships, class 0 first. The order depends on the combinations alone, and groups the classes
/// of a subtree. `graph` must contain the structure of every membership.
[[nodiscard]] std::vector<ClassId> storage_order(const ClassTable& classes, const StructureGraph& graph);

}  // namespace splatlas
