// The surface between a structure's voxels and the rest, by VTK.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "preprocess/surfaces/structure_crop.h"

namespace splatlas {

struct FittedSurface {
  std::vector<std::array<float, 3>>
      positions_ijk;  ///< in the grid's indices; one coordinate of each ends in .5
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside, in index space
};

/// Marching cubes at 0.5 on the crop's zeros and ones (Lorensen and Cline 1987; VTK's flying edges gives the
/// same triangles ten times faster than its marching cubes). Closed; equal vertices are one. Safe to call
/// from several threads.
[[nodiscard]] FittedSurface marching_cubes(const StructureCrop& crop);

}  // namespace splatlas
