// Interior and boundary of a structure from its runs: files keep one list for both.
#pragma once

#include <span>
#include <vector>

#include "format/class_table.h"
#include "format/derive/value_groups.h"
#include "format/grid.h"
#include "format/run_model.h"

namespace splatlas {

struct SplitRuns {
  ClassRuns interior, boundary;
  friend bool operator==(const SplitRuns&, const SplitRuns&) = default;
};

/// Runs of two classes that share no voxel as one list of maximal runs.
[[nodiscard]] ClassRuns join_runs(std::span<const Run> a, std::span<const Run> b);

/// Splits `runs`, which pass validate_runs(), into voxels all of whose 18 neighbours (sharing a face or an
/// edge) are covered too, and the others; beyond the grid nothing is covered. Works on bits: cost linear in
/// the runs and a 64th of their voxels, memory nine scanlines of bits.
[[nodiscard]] SplitRuns split_boundary(std::span<const Run> runs, const Index3& size, Axis axis);

/// [group]: whether it has just an interior and a boundary class, in this order, of structures that no other
/// group holds: then which voxel is of which class follows from the group's voxels. Cost: linear in the
/// memberships.
[[nodiscard]] std::vector<bool> find_split_groups(const ValueGroups& groups, const ClassTable& table);

/// How the runs of the classes of a file lie in its streams: the two classes of a split group share the
/// stream of the first where the second, which has voxels, has a stream of no bytes.
class RunStreams {
 public:
  explicit RunStreams(const ClassTable& table);

  /// Whether a class has its list together with another one, given the length of every class's list.
  template <typename BytesOf>
  [[nodiscard]] bool is_shared(const ClassTable& table, ClassId c, BytesOf&& bytes_of) const {
    const std::vector<ClassId>& of = groups_.classes[groups_.group_of[c]];
    return split_[groups_.group_of[c]] && table.voxels(of[1]) > 0 && bytes_of(of[1]) == 0;
  }
  /// The first and the second class of a class's group.
  [[nodiscard]] std::span<const ClassId> pair_of(ClassId c) const {
    return groups_.classes[groups_.group_of[c]];
  }
  [[nodiscard]] bool may_share(ClassId c) const { return split_[groups_.group_of[c]]; }
  [[nodiscard]] const ValueGroups& groups() const { return groups_; }

 private:
  ValueGroups groups_;
  std::vector<bool> split_;  // [group]
};

}  // namespace splatlas
