// Structures of labels or masks, with their voxels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/voxel_type.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/source_structure.h"
#include "preprocess/membership_volume.h"

namespace splatlas {

/// Voxels are in the storage order of `source_grid`; structures have source numbers.
struct ImportedLabels {
  Grid source_grid;
  std::string source;                 ///< the file with the grid, for messages
  VoxelType type = VoxelType::kNone;  ///< of the label map; kNone for masks and overlapping segments
  MembershipVolume memberships{Index3{0, 0, 0}};
  std::vector<SourceStructure> structures;
  std::vector<std::filesystem::path> files;  ///< the files read, in a fixed order
  Notes notes;
};

}  // namespace splatlas
