// Splitting of a structure's runs into interior and boundary: files store one list for both.
#pragma once

#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/derive/value_groups.h"

namespace splatlas {

/// Runs of the interior and the boundary voxels.
struct SplitRuns {
  ClassRuns interior, boundary;
  friend bool operator==(const SplitRuns&, const SplitRuns&) = default;
};

/// Merges the runs of two disjoint classes into one list of maximal runs.
[[nodiscard]] ClassRuns join_runs(std::span<const Run> a, std::span<const Run> b);

/// Splits `runs` into interior voxels, with all 18 neighbours (sharing a face or an edge) covered, and
/// boundary voxels. `runs` must pass validate_runs(). Voxels beyond the grid are not covered. Bit-parallel:
/// cost linear in the runs and in voxels / 64; memory: nine scanlines of bits.
[[nodiscard]] SplitRuns split_boundary(std::span<const Run> runs, const Index3& size, Axis axis);

/// [group]: true for a group of exactly one interior and one boundary class, in this order, of structures
/// that are in no other group. Its voxels then determine both. Linear in the memberships.
[[nodiscard]] std::vector<bool> find_split_groups(const ValueGroups& groups, const ClassTable& table);

/// Assignment of the runs of classes to streams. The two classes of a split group share the stream of the
/// first class if the second class has voxels and an empty stream.
class RunStreams {
 public:
  explicit RunStreams(const ClassTable& table);

  /// True if a class shares its list with another one. `bytes_of` maps a class to the length of its stream.
  template <typename BytesOf>
  [[nodiscard]] bool is_shared(const ClassTable& table, ClassId c, BytesOf&& bytes_of) const {
    const std::vector<ClassId>& of = groups_.classes[groups_.group_of[c]];
    return split_[groups_.group_of[c]] && table.voxels(of[1]) > 0 && bytes_of(of[1]) == 0;
  }
  /// Classes in the group of a class.
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
