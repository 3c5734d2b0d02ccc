// The part of the class volume around one structure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/derive/held_classes.h"
#include "format/grid.h"
#include "format/run_model.h"

namespace splatlas {

/// How a box of voxels belongs to one structure. A whole structure's has one voxel more than its box on every
/// side, so that the outermost voxels are outside; those beyond the grid exist here too.
struct StructureCrop {
  static constexpr std::uint8_t kOutside = 0, kInterior = 1, kBoundary = 2;

  Index3 first{0, 0, 0};  ///< of the grid's indices; -1 where the structure touches the border
  Index3 size{0, 0, 0};
  std::vector<std::uint8_t> parts;  ///< kOutside (or only crossed), kInterior or kBoundary; i fastest

  [[nodiscard]] static std::uint8_t part_of(Part held) {
    return held == Part::kBoundary ? kBoundary : kInterior;
  }
  [[nodiscard]] std::size_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * size[1] + j) * size[0] + i);
  }
};

/// Calls visit(i, j, offset in the grid) for the voxels of slice k of a whole structure's crop that the
/// structure holds; i and j are the crop's.
template <typename Visit>
void for_each_held(const StructureCrop& crop, std::int64_t k, const Grid& grid, const Visit& visit) {
  for (std::int64_t j = 1; j + 1 < crop.size[1]; ++j) {
    for (std::int64_t i = 1; i + 1 < crop.size[0]; ++i) {
      if (crop.parts[crop.offset(i, j, k)] == StructureCrop::kOutside) continue;
      visit(i, j,
            static_cast<std::size_t>(grid.offset(i + crop.first[0], j + crop.first[1], k + crop.first[2])));
    }
  }
}

/// How voxels of each of so many classes belong to the structure that holds some of them.
[[nodiscard]] std::vector<std::uint8_t> parts_of(std::span<const HeldClass> held, std::size_t classes);

/// Cuts out `box`, which must not be empty. `parts` is parts_of(...).
[[nodiscard]] StructureCrop crop_structure(std::span<const ClassId> volume, const Index3& size,
                                           const IndexBox& box, std::span<const std::uint8_t> parts);

/// `box` and one voxel more on every side, all outside: to be painted.
[[nodiscard]] StructureCrop empty_crop(const IndexBox& box);
/// Writes what of these runs (of principal axis z, valid in a grid with `rows` rows a slice) lies in the
/// crop.
void paint_runs(std::span<const Run> runs, std::int64_t rows, std::uint8_t part, StructureCrop& crop);

}  // namespace splatlas
