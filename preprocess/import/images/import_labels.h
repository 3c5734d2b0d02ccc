// Reads what structures hold each voxel: a label map, or a folder with one mask per structure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/voxel_type.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/tables/read_names.h"
#include "preprocess/membership_volume.h"
#include "preprocess/source_structure.h"

namespace splatlas {

/// Voxels are in the storage order of `source_grid`; structures have source numbers.
struct ImportedLabels {
  Grid source_grid;
  std::string source;                 ///< the file that gave the grid, for messages
  VoxelType type = VoxelType::kNone;  ///< of the label map; kNone for masks
  MembershipVolume memberships{Index3{0, 0, 0}};
  std::vector<SourceStructure> structures;
  std::vector<std::filesystem::path> files;  ///< what was read, in a fixed order
  std::vector<std::string> notes;            ///< oddities that are no errors, one line each
};

/// A label map: every value above 0 is a structure, named "Label 7" until name_labels. Floats must be whole.
/// kFailed for negative, broken and too large (2^32 and above) labels, with the value.
[[nodiscard]] Result<ImportedLabels> import_label_map(const std::filesystem::path& path);
/// The same from memory; `name` stands for the file in messages.
[[nodiscard]] Result<ImportedLabels> read_label_map(Image image, const std::string& name);

/// A folder of masks on one grid (TotalSegmentator's way): the file's name is the structure's, what is not 0
/// it holds, masks may overlap. Structures that hold more voxels come first, so that of two that overlap the
/// more specific one has the higher number. Empty masks stay, as structures without voxels, with a note.
[[nodiscard]] Result<ImportedLabels> import_mask_folder(const std::filesystem::path& folder);

/// Gives the structures of a label map their names, codes and colours. Refuses labels without a name, and
/// names (of `file`, with their lines) without a voxel, which `allow_empty` keeps as empty structures
/// instead.
[[nodiscard]] Result<void> name_labels(ImportedLabels& labels, const std::vector<LabelName>& names,
                                       const std::string& file, bool allow_empty);

}  // namespace splatlas
