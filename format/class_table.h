// Classes: the distinct combinations of structures and surfaces that a voxel can belong to.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/structure_graph.h"

namespace splatlas {

/// Classes partition the voxels, so that one run model serves every selection (paper, section 3, figure 3).
using ClassId = std::uint32_t;
inline constexpr ClassId kEmptyClass = 0;  ///< voxels that no structure holds and no surface crosses

/// How a voxel of a class belongs to a structure.
enum class Part : std::uint8_t {
  kInterior = 0,  ///< held, with all 18 neighbours held too
  kBoundary = 1,  ///< held, and at least one of the 18 neighbours is outside (beyond the grid is outside)
  kCrossed = 2,   ///< not held: crossed by the structure's external surface
};

struct Membership {
  StructureIndex structure = kNoStructure;
  Part part = Part::kInterior;
  friend auto operator<=>(const Membership&, const Membership&) = default;
  [[nodiscard]] bool holds() const { return part != Part::kCrossed; }
};

/// Voxels first..last, both included; empty when first > last.
struct IndexBox {
  Index3 first{0, 0, 0};
  Index3 last{-1, -1, -1};
  friend bool operator==(const IndexBox&, const IndexBox&) = default;
  [[nodiscard]] bool empty() const { return first[0] > last[0]; }
  void include(const Index3& voxel);
  void include(const IndexBox& other);
};

/// For every class: its memberships (sorted by structure), voxel count and box. Class 0 is the empty class.
class ClassTable {
 public:
  ClassTable();

  /// The class of a combination; a new one the first time. `members` need not be sorted; repeats are merged
  /// (to boundary where their parts differ). Cost: logarithmic in the classes.
  ClassId intern(std::vector<Membership> members);
  /// Adds voxels to a class's count and box.
  void count(ClassId c, std::uint64_t voxels, const IndexBox& box);

  [[nodiscard]] std::size_t size() const { return voxels_.size(); }
  [[nodiscard]] std::span<const Membership> members(ClassId c) const;
  [[nodiscard]] std::uint64_t voxels(ClassId c) const { return voxels_[c]; }
  [[nodiscard]] const IndexBox& box(ClassId c) const { return boxes_[c]; }

  /// The same classes under new numbers: `order[n]` is the old number of new class n; order[0] must be 0.
  [[nodiscard]] ClassTable renumbered(std::span<const ClassId> order) const;

 private:
  std::vector<Membership> members_;
  std::vector<std::uint32_t> first_member_;  // size + 1 offsets into members_
  std::vector<std::uint64_t> voxels_;
  std::vector<IndexBox> boxes_;
  std::map<std::vector<Membership>, ClassId> index_;
};

/// Class numbers in the order in which the file stores their streams: class 0, then every other class at the
/// first of its structures in the graph's preorder, interior before boundary; then by the others, so that the
/// order depends on the combinations alone. A subtree is then one range. `graph` must hold every member's
/// structure.
[[nodiscard]] std::vector<ClassId> storage_order(const ClassTable& classes, const StructureGraph& graph);

}  // namespace splatlas
