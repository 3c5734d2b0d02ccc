// Importer of labels: a label map, a segmentation file, or a folder with one mask per structure.
#pragma once

#include <filesystem>
#include <optional>

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/labels/imported_labels.h"

namespace splatlas {

/// Reads what `path` holds: label maps (label_map.h), segmentations (segment_layers.h), or masks
/// (mask_folder.h). With `grid`, labels on another grid are resampled to it, to the nearest voxel;
/// ImportedLabels::resampled tells the structures' voxels and volumes before and after.
[[nodiscard]] Result<ImportedLabels> import_labels(const std::filesystem::path& path,
                                                   const ImageOptions& options = {},
                                                   const std::optional<Grid>& grid = std::nullopt);

}  // namespace splatlas
