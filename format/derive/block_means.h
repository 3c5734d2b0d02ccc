// Mean grey values of a group of classes in blocks of voxels, for first pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/content/voxel_type.h"
#include "format/derive/value_groups.h"

namespace splatlas {

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
