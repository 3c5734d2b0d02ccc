// Importer of labels: a label map, a segmentation file, or a folder with one mask per structure.
#pragma once

#include <filesystem>
#include <optional>

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/labels/label_map.h"

namespace splatlas {

/// Reads what `path` holds: label maps (label_map.h), segmentations, or masks. Every segment is a structure;
/// those of several layers may overlap, and the larger come first; those of one layer keep their value as
/// label. Notes count segments without voxels, which are dropped, and voxels of values without a segment.
/// With `grid`, labels on another grid are resampled to it, to the nearest voxel; ImportedLabels::resampled
/// tells the structures' voxels and volumes before and after.
[[nodiscard]] Result<ImportedLabels> import_labels(const std::filesystem::path& path,
                                                   ImageOptions options = {},
                                                   const std::optional<Grid>& grid = std::nullopt);

/// Imports a folder with one mask per structure, as TotalSegmentator writes: a structure has the name of its
/// file and the voxels that are not 0. Masks may overlap; larger ones come first. Files with more than 16
/// values, or negative ones, hold grey values and are left out; empty masks are dropped; both are counted in
/// notes. All masks have the grid `grid`, or the most frequent one; others are resampled to the nearest
/// voxel, with a note. kFailed for files that cannot be read, for two names that differ in case only, and if
/// no mask has a voxel.
[[nodiscard]] Result<ImportedLabels> import_mask_folder(const std::filesystem::path& folder,
                                                        const std::optional<Grid>& grid = std::nullopt);

/// Adds the structures of another label map. Both move to the smallest grid that holds them; where they
/// overlap, voxels are in both. kFailed unless the voxels of both lie on one lattice.
[[nodiscard]] Result<void> add_labels(ImportedLabels others, ImportedLabels& labels);

}  // namespace splatlas
