// Importer of labels: a label map, or a folder with one mask per structure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/voxel_type.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/tables/read_names.h"
#include "preprocess/membership_volume.h"

namespace splatlas {

/// Voxels are in the storage order of `source_grid`; structures have source numbers.
struct ImportedLabels {
  Grid source_grid;
  std::string source;                 ///< the file with the grid, for messages
  VoxelType type = VoxelType::kNone;  ///< of the label map; kNone for masks
  MembershipVolume memberships{Index3{0, 0, 0}};
  std::vector<SourceStructure> structures;
  std::vector<std::filesystem::path> files;  ///< the files read, in a fixed order
  std::vector<std::string> notes;            ///< warnings, one line each
};

/// Imports a label map: every value above 0 is a structure, named "Label 7" until name_labels. kFailed, with
/// the value, for labels that are negative, fractional, or 2^32 and above.
[[nodiscard]] Result<ImportedLabels> import_label_map(const std::filesystem::path& path);
/// The same from memory; `name` stands for the file in messages.
[[nodiscard]] Result<ImportedLabels> read_label_map(Image image, const std::string& name);

/// Imports a folder of masks on one grid, as TotalSegmentator writes. A structure has the name of its file
/// and the voxels that are not 0; masks may overlap. Larger structures come first: of two that overlap, the
/// more specific one has the higher number. An empty mask gives a structure without voxels, and a note.
[[nodiscard]] Result<ImportedLabels> import_mask_folder(const std::filesystem::path& folder);

/// Sets names, codes and colours of the structures of a label map. kFailed for labels without a name. Names
/// without a voxel become empty structures with `allow_empty`; otherwise kFailed with `file` and line.
[[nodiscard]] Result<void> name_labels(ImportedLabels& labels, const std::vector<LabelName>& names,
                                       const std::string& file, bool allow_empty);

}  // namespace splatlas
