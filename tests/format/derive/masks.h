// Masks of one structure, as crops with their boundary.
#pragma once

#include <cstdint>
#include <vector>

#include "format/derive/structure_crop.h"

namespace splatlas {

/// The voxels of a grid that a structure holds, i fastest.
struct Mask {
  Index3 size{0, 0, 0};
  std::vector<std::uint8_t> held;

  /// False beyond the grid.
  [[nodiscard]] bool holds(const Index3& at) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= size[a]) return false;
    }
    return held[static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0])] != 0;
  }
};

/// `holds(i, j, k)` for every voxel.
template <typename Holds>
Mask mask_of(const Index3& size, const Holds& holds) {
  Mask mask{size, {}};
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) mask.held.push_back(holds(i, j, k) ? 1 : 0);
    }
  }
  return mask;
}

/// The crop of the whole grid: a held voxel is boundary if one of its 18 neighbours is not held.
inline StructureCrop crop_of(const Mask& mask) {
  StructureCrop crop = empty_crop({{0, 0, 0}, {mask.size[0] - 1, mask.size[1] - 1, mask.size[2] - 1}});
  for (std::int64_t k = 0; k < mask.size[2]; ++k) {
    for (std::int64_t j = 0; j < mask.size[1]; ++j) {
      for (std::int64_t i = 0; i < mask.size[0]; ++i) {
        if (!mask.holds({i, j, k})) continue;
        bool is_boundary = false;
        for (std::int64_t n = 0; n < 27; ++n) {
          const Index3 step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
          const bool is_neighbour = step[0] == 0 || step[1] == 0 || step[2] == 0;
          if (is_neighbour && !mask.holds({i + step[0], j + step[1], k + step[2]})) is_boundary = true;
        }
        crop.parts[crop.offset(i + 1, j + 1, k + 1)] =
            is_boundary ? StructureCrop::kBoundary : StructureCrop::kInterior;
      }
    }
  }
  return crop;
}

}  // namespace splatlas
