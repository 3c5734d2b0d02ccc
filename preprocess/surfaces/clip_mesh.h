// Cuts an external surface along the voxels of a grid, so that it is played like a fitted one.
#pragma once

#include <cstdint>
#include <vector>

#include "format/grid.h"
#include "format/surface.h"
#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

struct ClippedMesh {
  SurfaceMesh surface;  ///< each triangle within one voxel, sorted by voxel; positions in 1/1024 voxel
  std::vector<std::int64_t>
      crossed;         ///< memory offsets of the voxels with a triangle; sorted, without repeats
  double outside = 0;  ///< fraction of the area that lies beyond the grid and was dropped
};

/// Clips every triangle against the voxel boxes (planes at half-integer indices; paper, section 3).
/// Neighbouring triangles stay joined: what they share is cut at the same places. A triangle in the very
/// plane between two voxels goes to the upper one. Normals are the file's, or vertex_normals, interpolated
/// where edges are cut. kLimit above 2^26 pieces. Cost: linear in the pieces.
[[nodiscard]] Result<ClippedMesh> clip_mesh(const TriangleMesh& mesh, const Grid& grid);

}  // namespace splatlas
