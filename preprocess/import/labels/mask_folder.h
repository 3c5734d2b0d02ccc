// Structures of a folder of masks.
#pragma once

#include <filesystem>
#include <optional>

#include "preprocess/import/labels/imported_labels.h"

namespace splatlas {

/// True for a folder with image files.
[[nodiscard]] bool is_mask_folder(const std::filesystem::path& path);

/// Imports a folder with one mask per structure, as TotalSegmentator writes: a structure has the name of its
/// file and the voxels that are not 0. Masks may overlap; larger ones come first. Files with more than 16
/// values, or negative ones, hold grey values and are left out; empty masks are dropped; both are counted in
/// notes. All masks have the grid `grid`, or the most frequent one; others are resampled to the nearest
/// voxel, with a note. kFailed for files that cannot be read, for two names that differ in case only, and if
/// no mask has a voxel.
[[nodiscard]] Result<ImportedLabels> import_mask_folder(const std::filesystem::path& folder,
                                                        const std::optional<Grid>& grid = std::nullopt);

}  // namespace splatlas
