// Atlas without classes and runs: dense volumes and all surfaces.
#pragma once

#include <vector>

#include "format/atlas_reader.h"

namespace splatlas {

/// All voxels in memory order of the grid.
struct VoxelModel {
  Grid grid;
  std::vector<ClassId> classes;
  VoxelBuffer values;                 ///< kNone and empty if the atlas has none
  std::vector<PackedNormal> normals;  ///< boundary voxels; 0 elsewhere
  std::vector<SurfaceMesh> surfaces;  ///< per structure
};

[[nodiscard]] Result<VoxelModel> read_voxel_model(const Atlas& atlas);

}  // namespace splatlas
