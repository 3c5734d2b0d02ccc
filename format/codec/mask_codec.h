// The run lists of compact files, as bytes: the voxels of a box, bit by bit, each told by those around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/result.h"
#include "format/run_model.h"

namespace splatlas {

/// What a mask's code begins with; no run list does.
inline constexpr std::byte kMaskMark{0};

/// Whether `voxels` in a box may be coded as a mask: those that fill so little of it that most of the bits
/// tell nothing may not, nor those in boxes whose slices take much memory.
[[nodiscard]] bool codes_mask(const IndexBox& box, std::uint64_t voxels);

/// The code of runs along `axis` that lie in `box`, for which codes_mask() holds.
[[nodiscard]] std::vector<std::byte> encode_mask(std::span<const Run> runs, const IndexBox& box,
                                                 const Index3& size, Axis axis);

/// The runs again, maximal and in order. kInvalidAtlas for what is no code of `voxels` voxels in `box`. Cost:
/// linear in the box's voxels, some 5 ns each; memory: three slices of the box, a byte a voxel.
[[nodiscard]] Result<ClassRuns> decode_mask(std::span<const std::byte> bytes, const IndexBox& box,
                                            const Index3& size, Axis axis, std::uint64_t voxels);

}  // namespace splatlas
