// Extraction of structure surfaces and boundary normals.
#pragma once

#include <functional>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/content/unit_vector.h"
#include "format/content/voxel_type.h"
#include "preprocess/classify/classify_voxels.h"

namespace splatlas {

struct ExtractedSurfaces {
  std::vector<SurfaceMesh> surfaces;                        ///< per structure; empty without voxels
  std::vector<std::vector<PackedNormal>> boundary_normals;  ///< per class, as in AtlasContent
  std::vector<FittedSurface> fitted;                        ///< per structure, as in AtlasContent
  /// Number of surfaces whose triangles do not follow from voxels, see adopt_triangles(). Files store them.
  std::size_t not_derived = 0;
};

/// A structure whose surface is an isosurface of the grey values.
struct Isosurface {
  StructureIndex structure = kNoStructure;
  double level = 0;  ///< inside from here on
};

struct ExtractOptions {
  SurfaceRule rule = SurfaceRule::kSmooth;
  unsigned threads = 0;                  ///< 0: one per core. The result does not depend on it.
  std::function<void(double)> progress;  ///< receives the fraction done on the calling thread; may be empty
  std::vector<Isosurface> isosurfaces = {};  ///< see move_to_isosurface()
  const VoxelBuffer* values = nullptr;       ///< grey values for isosurfaces
  bool keeps_fitted = true;                  ///< false: `fitted` stands for surfaces that readers derive
};

/// Extracts the surface of each structure's own voxels with VTK (marching cubes, Lorensen and Cline 1987),
/// closed at the border of the grid, and compares it with fit_surface(), which readers use. Boundary normals
/// come from the mask smoothed with a Gaussian of one voxel. A boundary voxel of several structures has the
/// normal of the lowest index. Errors name the structure. Parallel over structures. Memory per thread: a byte
/// per voxel of a structure's box, five of an isosurface's, and about 200 per vertex.
[[nodiscard]] Result<ExtractedSurfaces> extract_surfaces(const ClassifiedVoxels& classification,
                                                         const StructureGraph& graph,
                                                         const Grid& storage_grid,
                                                         const ExtractOptions& options = {});

}  // namespace splatlas
