// Context-adaptive binary coding of class masks, the run lists of compact files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/result.h"

namespace splatlas {

/// First byte of every mask; no run list starts with it.
inline constexpr std::byte kMaskMark{0};

/// True if `voxels` voxels in a box may be coded as a mask. Excludes sparse boxes, in which most bits are
/// wasted, and boxes with limits of memory or decoding time exceeded.
[[nodiscard]] bool codes_mask(const IndexBox& box, std::uint64_t voxels);

/// Encodes runs along `axis` inside `box`. Requires codes_mask().
[[nodiscard]] std::vector<std::byte> encode_mask(std::span<const Run> runs, const IndexBox& box,
                                                 const Index3& size, Axis axis);

/// Decodes the runs, maximal and in order. kInvalidAtlas unless the bytes encode `voxels` voxels in `box`.
/// Safe on untrusted bytes. About 5 ns per voxel of the box, and a byte per voxel of three slices.
[[nodiscard]] Result<ClassRuns> decode_mask(std::span<const std::byte> bytes, const IndexBox& box,
                                            const Index3& size, Axis axis, std::uint64_t voxels);

}  // namespace splatlas
