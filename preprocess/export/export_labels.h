// Export of label maps and masks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "format/content/atlas_content.h"

namespace splatlas {

/// Reorders voxels from the storage grid to the source grid.
[[nodiscard]] VoxelBuffer to_source_order(const VoxelBuffer& stored, const AtlasContent& content);

/// Writes the source label map, voxel for voxel, as a volume file, without structures that have no label
/// (segments, surfaces). kFailed if labels overlap, and for a label that label_type cannot hold exactly.
/// Messages call the atlas `name`.
[[nodiscard]] Result<void> export_label_map(const AtlasContent& content, const std::string& name,
                                            const std::filesystem::path& path);

/// The masks of a folder.
struct ExportedMasks {
  std::size_t count = 0;
  std::vector<std::string> notes;  ///< one line each: on the ending, on ids that are no safe file names
};

/// Writes one mask (uint8, 1 inside) per structure to a new or empty folder, atomically: ID.nii.gz, or
/// ID.nrrd if NIfTI cannot hold the grid. Groups and external surfaces have no mask. Ids that are unsafe as
/// file names are changed by file_names_of().
[[nodiscard]] Result<ExportedMasks> export_masks(const AtlasContent& content,
                                                 const std::filesystem::path& folder);

}  // namespace splatlas
