// Morphological closing and opening of masks.
#pragma once

#include <cstdint>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

/// Opening or closing of a mask (0 or 1, i fastest) of `size` by the ellipsoid of these radii in voxels,
/// which has the voxels of ITK's BinaryBallStructuringElement. Cost: a few instructions for 64 voxels and
/// each row of the ellipsoid. Memory: 1 bit per voxel, two times. Uses all cores. Closing: beyond the grid
/// counts as outside, and a structure can reach there.
void close_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii);
/// Opening: beyond the grid counts as inside.
void open_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii);

}  // namespace splatlas
