// Second reader of atlas files, implemented from docs/atlas_format.md only. It shares no code with the
// library, is slow and simple, and trusts its input. It ignores surfaces and derived parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace splatlas::second {

struct Atlas {
  std::array<std::int64_t, 3> size{};  ///< storage grid
  std::uint8_t value_type = 0;
  /// [axis x, y, z]: the class of every voxel in memory order from that run model; empty if it is not stored.
  std::array<std::vector<std::uint32_t>, 3> class_volume;
  std::vector<std::byte> values;                    ///< of every voxel in memory order
  std::vector<std::vector<std::uint16_t>> normals;  ///< [class]; empty if none are stored
};

/// Throws std::runtime_error for unsupported input.
[[nodiscard]] Atlas read_atlas(const std::vector<std::byte>& file);

}  // namespace splatlas::second
