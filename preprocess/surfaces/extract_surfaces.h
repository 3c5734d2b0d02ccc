// Fits a surface to every structure that holds voxels, and gives boundary voxels their normals.
#pragma once

#include <functional>
#include <vector>

#include "format/grid.h"
#include "format/surface.h"
#include "format/unit_vector.h"
#include "preprocess/classify/classify_voxels.h"

namespace splatlas {

struct ExtractedSurfaces {
  std::vector<SurfaceMesh> surfaces;  ///< per structure, as surface.h says; empty where it holds no voxel
  std::vector<std::vector<PackedNormal>> boundary_normals;  ///< per class, as AtlasContent says
};

/// Marching cubes on each structure's own voxels, closed at the border of the grid. Normals, of vertices and
/// of boundary voxels, are those of the structure's mask smoothed with a Gaussian of one voxel; a boundary
/// voxel of several structures takes the first one's (lowest index). `progress` (may be empty) gets the
/// fraction done, from the calling thread. Structures are worked on in parallel; the result does not depend
/// on `threads` (0: all cores). Memory: a byte for every voxel of the largest structures' boxes, one per
/// thread, and two a voxel of the grid.
[[nodiscard]] ExtractedSurfaces extract_surfaces(const Classification& classification,
                                                 const StructureGraph& graph, const Grid& storage_grid,
                                                 unsigned threads = 0,
                                                 const std::function<void(double)>& progress = {});

}  // namespace splatlas
