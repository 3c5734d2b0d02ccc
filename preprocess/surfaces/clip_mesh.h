// Clipping of external meshes to a grid.
#pragma once

#include <cstdint>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

struct ClippedMesh {
  SurfaceMesh surface;                ///< positions in units of 1/1024 voxel
  std::vector<std::int64_t> crossed;  ///< memory offsets of the voxels that it crosses; sorted, unique
  double outside = 0;                 ///< fraction of the area outside the grid, which is dropped
};

/// Clips triangles at the border of the grid (Sutherland and Hodgman 1974), alike at shared edges, and finds
/// the voxels that they cross. In the plane between two voxels, that is the upper one. Uses the normals of
/// the file or corner_normals(), interpolated linearly at cuts. kLimit above 2^26 crossings of a triangle and
/// a voxel, to which the cost is linear.
[[nodiscard]] Result<ClippedMesh> clip_mesh(const TriangleMesh& mesh, const Grid& grid);

}  // namespace splatlas
