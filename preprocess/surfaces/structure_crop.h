// The part of the class volume around one structure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/class_table.h"

namespace splatlas {

/// The structure's box and one voxel more on every side, so that whatever the structure touches, the
/// outermost voxels are outside. Those beyond the grid exist here too.
struct StructureCrop {
  Index3 first{0, 0, 0};  ///< of the grid's indices; -1 where the structure touches the border
  Index3 size{0, 0, 0};
  std::vector<std::uint8_t> inside;  ///< 1 where the structure holds the voxel, else 0; i fastest

  [[nodiscard]] std::size_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * size[1] + j) * size[0] + i);
  }
};

/// How voxels of each class belong to `structure`: 0 not at all (or only crossed), 1 interior, 2 boundary.
[[nodiscard]] std::vector<std::uint8_t> parts_of(const ClassTable& classes, StructureIndex structure);

/// Cuts out `box`, which must not be empty. `parts` is parts_of(...).
[[nodiscard]] StructureCrop crop_structure(std::span<const ClassId> volume, const Index3& size,
                                           const IndexBox& box, std::span<const std::uint8_t> parts);

}  // namespace splatlas
