// The atlas as it was before it had classes and runs: dense volumes and all surfaces.
#pragma once

#include <vector>

#include "format/atlas_reader.h"

namespace splatlas {

/// Every voxel in memory order of the grid, nothing left out.
struct VoxelModel {
  Grid grid;
  std::vector<ClassId> classes;
  VoxelBuffer values;                 ///< type kNone and no bytes where the atlas has none
  std::vector<PackedNormal> normals;  ///< of boundary voxels; 0 elsewhere
  std::vector<SurfaceMesh> surfaces;  ///< per structure
};

[[nodiscard]] Result<VoxelModel> read_voxel_model(const Atlas& atlas);

}  // namespace splatlas
