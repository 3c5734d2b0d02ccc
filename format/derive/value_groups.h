// Groups of classes for the coding of grey values, and means of blocks of their voxels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/content/voxel_type.h"

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

/// The blocks of a box of voxels, or of a grid.
[[nodiscard]] IndexBox box_of_blocks(const IndexBox& box);
[[nodiscard]] Index3 blocks_of_grid(const Index3& size);

/// True if a group with this box may have means: bounds the memory of blocks_of().
[[nodiscard]] bool may_have_means(const IndexBox& box);

/// The blocks with voxels of a group, in memory order of the grid of blocks.
struct GroupBlocks {
  std::vector<ClassSpan> spans;      ///< runs of blocks along i; their class is not used
  std::vector<std::uint8_t> voxels;  ///< [block]: voxels of the group, 1 to 64
};

/// `spans` are the voxels of a group in memory order of a grid of `size`, inside `box`. Cost: linear in the
/// voxels / 4 and in the blocks between the first and the last one of a row. Memory: a slice of the box.
[[nodiscard]] GroupBlocks blocks_of(std::span<const ClassSpan> spans, const IndexBox& box,
                                    const Index3& size);
/// The mean of the values in each block: of integers the nearest one, halves upwards; of floating-point
/// numbers their sum in double precision and memory order, divided by their number. `values` are in the order
/// of the spans. Cost: linear in the voxels.
[[nodiscard]] std::vector<std::byte> block_means(std::span<const ClassSpan> spans, const IndexBox& box,
                                                 const Index3& size, VoxelType type,
                                                 std::span<const std::byte> values);

}  // namespace splatlas
