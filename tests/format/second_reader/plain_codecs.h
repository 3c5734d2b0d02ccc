// Decoders of masks, predicted grey values and means, voxel by voxel (docs/atlas_format.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace splatlas::second {

/// The voxels of a grid that a mask of a box covers, in memory order.
[[nodiscard]] std::vector<bool> decode_mask(const std::vector<std::byte>& stream,
                                            const std::array<std::int64_t, 3>& first,
                                            const std::array<std::int64_t, 3>& last,
                                            const std::array<std::int64_t, 3>& size, std::size_t axis);

/// Bytes ahead of the residuals.
inline constexpr std::uint64_t kModelBytes = 16 * 4 + 14 + 1 + 1;

[[nodiscard]] bool is_predicted(std::uint8_t type, std::uint64_t voxels, std::int64_t width,
                                std::int64_t height);

/// The values of the voxels of a group, in ascending memory order.
[[nodiscard]] std::vector<std::byte> decode_predicted(const std::vector<std::byte>& stream,
                                                      const std::vector<std::size_t>& voxels,
                                                      const std::array<std::int64_t, 3>& size,
                                                      std::uint8_t type);

/// Blocks of 4 x 4 x 4 voxels with voxels of a group.
struct Blocks {
  std::array<std::int64_t, 3> size{};                      ///< of the grid of blocks
  std::map<std::size_t, std::vector<std::size_t>> voxels;  ///< [block], of the group, in memory order
  bool predicted = false;
};
[[nodiscard]] Blocks blocks_of(const std::vector<std::size_t>& voxels,
                               const std::array<std::int64_t, 3>& size, std::uint8_t type);
/// True if a stream has the means of the values in these blocks.
[[nodiscard]] bool has_means(const Blocks& blocks, const std::vector<std::byte>& stream,
                             const std::vector<std::byte>& values, std::uint8_t type);

}  // namespace splatlas::second
