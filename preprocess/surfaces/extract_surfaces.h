// Extraction of structure surfaces and boundary normals.
#pragma once

#include <functional>
#include <vector>

#include "format/grid.h"
#include "format/surface.h"
#include "format/unit_vector.h"
#include "preprocess/classify/classify_voxels.h"

namespace splatlas {

/// Surfaces and normals of all structures.
struct ExtractedSurfaces {
  std::vector<SurfaceMesh> surfaces;                        ///< per structure; empty without voxels
  std::vector<std::vector<PackedNormal>> boundary_normals;  ///< per class, as in AtlasContent
};

/// Extracts the surface of each structure's own voxels by fit_surface() (marching cubes, Lorensen and Cline
/// 1987), closed at the border of the grid. Normals come from the mask smoothed with a Gaussian of one voxel.
/// A boundary voxel of several structures has the normal of the lowest index. `progress` receives the
/// fraction done on the calling thread and may be empty. Parallel over structures; the result does not depend
/// on `threads` (0: one per core). Memory per thread: one byte per voxel of a structure's box; total: two
/// bytes per voxel of the grid.
[[nodiscard]] ExtractedSurfaces extract_surfaces(const Classification& classification,
                                                 const StructureGraph& graph, const Grid& storage_grid,
                                                 unsigned threads = 0,
                                                 const std::function<void(double)>& progress = {});

}  // namespace splatlas
