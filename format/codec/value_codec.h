// Grey values of one group of classes as bytes: each predicted from those before it in the group.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/derive/value_groups.h"
#include "format/grid.h"
#include "format/result.h"
#include "format/voxel_type.h"

namespace splatlas {

/// The voxels of a group: `spans` in memory order, all inside `box`.
struct GroupVoxels {
  std::span<const ClassSpan> spans;
  std::uint64_t voxels = 0;  ///< of the spans
  IndexBox box;
  std::int64_t rows = 0;  ///< scanlines a slice of the grid
};

/// Whether values of this type in this box are predicted: integers of 8 and 16 bits, in boxes whose slices
/// can be held in memory. Others are kept as they are.
[[nodiscard]] bool predicts_values(VoxelType type, const IndexBox& box, std::uint64_t voxels);
/// The length of their code.
[[nodiscard]] std::uint64_t value_code_bytes(VoxelType type, const IndexBox& box, std::uint64_t voxels);

/// `values`: of the voxels, in memory order, bytes_of(type) each.
[[nodiscard]] std::vector<std::byte> encode_values(const GroupVoxels& group, VoxelType type,
                                                   std::span<const std::byte> values);

/// The values again. kInvalidAtlas for spans outside the box and for code that does not fit the voxels; safe
/// with any bytes of the length that value_code_bytes() gives. Cost: linear in voxels and spans; memory: two
/// slices of the box.
[[nodiscard]] Result<std::vector<std::byte>> decode_values(const GroupVoxels& group, VoxelType type,
                                                           std::span<const std::byte> code);

}  // namespace splatlas
