// Classes whose voxels belong to the same structures: their grey values are coded together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/class_table.h"
#include "format/grid.h"
#include "format/run_model.h"

namespace splatlas {

/// Groups of classes that differ in no more than which voxels are boundary: a structure's interior and its
/// boundary, on which grey values go on smoothly. Numbered by their first classes; the empty class is in
/// group 0.
struct ValueGroups {
  std::vector<std::uint32_t> group_of;        ///< [class]
  std::vector<std::vector<ClassId>> classes;  ///< [group], rising

  explicit ValueGroups(const ClassTable& table);
  [[nodiscard]] std::size_t size() const { return classes.size(); }
  /// The classes whose runs tell where a group's voxels are: its own; for the empty class's group, which has
  /// what the others leave, all.
  [[nodiscard]] std::vector<ClassId> told_by(std::size_t group) const;
};

/// Voxels of one group.
[[nodiscard]] std::uint64_t group_voxels(const ValueGroups& groups, const ClassTable& table,
                                         std::size_t group);
/// The box around them; all of the grid for the empty class's group.
[[nodiscard]] IndexBox group_box(const ValueGroups& groups, const ClassTable& table, std::size_t group,
                                 const Index3& size);

/// A run in principal axis z, with the class that it is of.
struct ClassSpan {
  Run run;
  ClassId of = kEmptyClass;
};

/// Runs of several classes in memory order. Cost: runs times the logarithm of classes.
[[nodiscard]] std::vector<ClassSpan> merge_runs(std::span<const ClassId> classes,
                                                std::span<const ClassRuns> runs);
/// What `spans` leave of the grid, as the empty class's. Overlaps count once.
[[nodiscard]] std::vector<ClassSpan> gaps_between(std::span<const ClassSpan> spans, const Index3& size);
/// The voxels of a group in memory order, from the runs of the classes of told_by().
[[nodiscard]] std::vector<ClassSpan> group_spans(const ValueGroups& groups, std::size_t group,
                                                 std::span<const ClassRuns> runs, const Index3& size);

}  // namespace splatlas
