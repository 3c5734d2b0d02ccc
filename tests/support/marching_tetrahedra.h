// Closed surfaces of voxel masks.
#pragma once

#include <vector>

#include "format/grid.h"
#include "format/surface.h"

namespace splatlas {

/// The surface halfway between the voxels of a mask and those outside (beyond the grid is outside): closed,
/// every triangle in one cell between eight voxel centres, positions at multiples of half a voxel. Every cell
/// is cut into the same six tetrahedra around its diagonal, so that faces meet (Payne and Toga 1990).
/// Triangles are counter-clockwise seen from outside in LPS, also in mirrored grids.
[[nodiscard]] SurfaceMesh marching_tetrahedra(const std::vector<bool>& mask, const Grid& grid);

}  // namespace splatlas
