// Bitwise decoder for masks of docs/atlas_format.md, Run lists.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace splatlas::second {

/// The voxels of a grid that a mask of a box covers, in memory order.
[[nodiscard]] std::vector<bool> decode_mask(const std::vector<std::byte>& stream,
                                            const std::array<std::int64_t, 3>& first,
                                            const std::array<std::int64_t, 3>& last,
                                            const std::array<std::int64_t, 3>& size, std::size_t axis);

}  // namespace splatlas::second
