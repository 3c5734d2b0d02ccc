// A second reader of atlas files, written after docs/atlas_format.md and nothing else: it shares no code with
// the first, is slow and plain, and believes what it reads. Surfaces, and what is fitted, it leaves alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace splatlas::second {

struct Atlas {
  std::array<std::int64_t, 3> size{};  ///< of the storage grid
  std::uint8_t value_type = 0;
  /// [axis x, y, z]: the class of every voxel in memory order, by that run model; empty where it is not
  /// stored.
  std::array<std::vector<std::uint32_t>, 3> class_volume;
  std::vector<std::byte> values;                    ///< of every voxel in memory order
  std::vector<std::vector<std::uint16_t>> normals;  ///< [class]; empty where none are stored
};

/// Throws std::runtime_error for what it cannot read.
[[nodiscard]] Atlas read_atlas(const std::vector<std::byte>& file);

}  // namespace splatlas::second
