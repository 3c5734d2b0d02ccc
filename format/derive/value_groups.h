// Groups of classes for the coding of grey values.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"

namespace splatlas {

/// Groups of classes in the same structures. Grey values are continuous across the classes of a group, which
/// differ only between interior and boundary. Numbered by their first class; the empty class is in group 0.
struct ValueGroups {
  std::vector<std::uint32_t> group_of;        ///< [class]
  std::vector<std::vector<ClassId>> classes;  ///< [group], ascending

  explicit ValueGroups(const ClassTable& table);
  [[nodiscard]] std::size_t size() const { return classes.size(); }
  /// The classes whose runs determine the voxels of a group: its own classes. For the group of the empty
  /// class, the complement of the others: all classes.
  [[nodiscard]] std::vector<ClassId> locating_classes(std::size_t group) const;
};

/// Number of voxels of one group.
[[nodiscard]] std::uint64_t group_voxels(const ValueGroups& groups, const ClassTable& table,
                                         std::size_t group);
/// Bounding box of one group; the whole grid for the group of the empty class.
[[nodiscard]] IndexBox group_box(const ValueGroups& groups, const ClassTable& table, std::size_t group,
                                 const Index3& size);

/// A run in principal axis z and its class.
struct ClassSpan {
  Run run;
  ClassId of = kEmptyClass;
};

/// Merges the runs of several classes in memory order. Cost: O(runs * log(classes)).
[[nodiscard]] std::vector<ClassSpan> merge_runs(std::span<const ClassId> classes,
                                                std::span<const ClassRuns> runs);
/// The complement of `spans` in the grid, as spans of the empty class. `spans` may overlap.
[[nodiscard]] std::vector<ClassSpan> gaps_between(std::span<const ClassSpan> spans, const Index3& size);
/// The voxels of a group in memory order, from the runs of locating_classes().
[[nodiscard]] std::vector<ClassSpan> group_spans(const ValueGroups& groups, std::size_t group,
                                                 std::span<const ClassRuns> runs, const Index3& size);

}  // namespace splatlas
