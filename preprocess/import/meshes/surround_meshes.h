// Grids that hold meshes.
#pragma once

#include <span>

#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/widen_grid.h"

namespace splatlas {

/// The voxels that a grid lacks to hold all points of the meshes, and one more.
[[nodiscard]] Margin margin_for(const Grid& grid, std::span<const TriangleMesh> meshes);

/// A grid around meshes alone: cubic voxels, 256 along the longest side, and a voxel of margin.
[[nodiscard]] Grid grid_around(std::span<const TriangleMesh> meshes);

}  // namespace splatlas
