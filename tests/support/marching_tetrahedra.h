// Closed surfaces of voxel masks by marching tetrahedra.
#pragma once

#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"

namespace splatlas {

/// The surface halfway between voxels inside and outside a mask (outside the grid is outside). It is closed,
/// each triangle lies in one cell of eight voxel centres, and positions are multiples of half a voxel. All
/// cells are split into the same six tetrahedra around their diagonal, so that faces match (Payne and Toga
/// 1990). Triangles are counter-clockwise seen from outside in LPS, in mirrored grids too.
[[nodiscard]] SurfaceMesh marching_tetrahedra(const std::vector<bool>& mask, const Grid& grid);

}  // namespace splatlas
