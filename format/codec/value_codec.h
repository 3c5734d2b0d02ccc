// Predictive coding of the grey values of a group of classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "format/derive/value_groups.h"
#include "format/result.h"

namespace splatlas {

/// The voxels of a group: `spans` in memory order, inside `box`.
struct GroupVoxels {
  std::span<const ClassSpan> spans;
  std::uint64_t voxels = 0;  ///< total of the spans
  IndexBox box;
  std::int64_t rows = 0;  ///< scanlines per slice of the grid
};

/// True if values are predicted: 8-bit and 16-bit integers in boxes with slices of limited size. Other values
/// are stored unchanged.
[[nodiscard]] bool predicts_values(VoxelType type, const IndexBox& box, std::uint64_t voxels);
/// Encoded length in bytes.
[[nodiscard]] std::uint64_t value_code_bytes(VoxelType type, const IndexBox& box, std::uint64_t voxels);

/// Encodes the values of the voxels in memory order, bytes_of(type) each.
[[nodiscard]] std::vector<std::byte> encode_values(const GroupVoxels& group, VoxelType type,
                                                   std::span<const std::byte> values);

/// Decodes the values. kInvalidAtlas for spans outside the box and for code that does not match the voxels.
/// Safe on untrusted bytes; `code` must have value_code_bytes() bytes. Cost: linear in voxels and spans.
/// Memory: three slices of the box.
[[nodiscard]] Result<std::vector<std::byte>> decode_values(const GroupVoxels& group, VoxelType type,
                                                           std::span<const std::byte> code);

}  // namespace splatlas
