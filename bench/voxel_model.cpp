#include "bench/voxel_model.h"

#include <utility>

#include "format/system/result_macros.h"

namespace splatlas {

Result<VoxelModel> read_voxel_model(const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content, atlas.read_all());
  VoxelModel model;
  model.grid = atlas.grid();
  model.classes = std::move(content.class_volume);
  model.values = std::move(content.values);
  model.surfaces = std::move(content.surfaces);

  // Normals are stored per class, each class in memory order.
  model.normals.assign(model.classes.size(), 0);
  std::vector<std::size_t> next(content.boundary_normals.size(), 0);
  for (std::size_t voxel = 0; voxel < model.classes.size(); ++voxel) {
    const ClassId c = model.classes[voxel];
    const std::vector<PackedNormal>& normals = content.boundary_normals[c];
    if (next[c] < normals.size()) model.normals[voxel] = normals[next[c]++];
  }
  return model;
}

}  // namespace splatlas
