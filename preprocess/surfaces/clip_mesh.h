// Clipping of external meshes to the voxels of a grid.
#pragma once

#include <cstdint>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

/// A mesh of triangles that each lie in one voxel.
struct ClippedMesh {
  SurfaceMesh surface;                ///< triangles sorted by voxel; positions in units of 1/1024 voxel
  std::vector<std::int64_t> crossed;  ///< memory offsets of the voxels with triangles; sorted, unique
  double outside = 0;                 ///< fraction of the area outside the grid, which is dropped
};

/// Clips every triangle at the voxel faces, planes at half-integer indices (Sutherland and Hodgman 1974).
/// Cuts of shared edges are identical, so that adjacent triangles share vertices. A triangle in the plane
/// between two voxels belongs to the upper one. Uses the normals of the file or vertex_normals(),
/// interpolated linearly at cuts. kLimit above 2^26 pieces. Cost: linear in the pieces.
[[nodiscard]] Result<ClippedMesh> clip_mesh(const TriangleMesh& mesh, const Grid& grid);

}  // namespace splatlas
