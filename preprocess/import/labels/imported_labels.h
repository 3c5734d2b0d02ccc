// Structures of labels or masks, with their voxels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/content/voxel_type.h"
#include "preprocess/import/membership_volume.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Sizes of a structure before and after its voxels moved to another grid.
struct ResampledStructure {
  std::string name;                   ///< in the file
  std::optional<std::int64_t> label;  ///< empty for masks
  std::uint64_t voxels_before = 0, voxels_after = 0;
  double ml_before = 0, ml_after = 0;
};

/// Voxels are in the storage order of `source_grid`; structures have source numbers.
struct ImportedLabels {
  Grid source_grid;
  std::string source;                 ///< the file with the grid, for messages
  VoxelType type = VoxelType::kNone;  ///< of the label map; kNone for masks and overlapping segments
  MembershipVolume memberships{Index3{0, 0, 0}};
  std::vector<SourceStructure> structures;
  std::vector<std::filesystem::path> files;   ///< the files read, in a fixed order
  std::vector<ResampledStructure> resampled;  ///< import_sources() notes them, under their final names
  Notes notes;
};

}  // namespace splatlas
