// Importer of volume files.
#pragma once

#include <filesystem>
#include <string>

#include "format/grid.h"
#include "format/voxel_type.h"

namespace splatlas {

/// One volume: voxels in the grid of the file, i fastest.
struct Image {
  Grid grid;  ///< LPS
  VoxelBuffer voxels;
};

/// Reads NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha, .mhd). A 2-D image is a volume of one
/// slice, a fourth dimension must have size 1. NIfTI's scl_slope and scl_inter are applied, which makes
/// floats. kFailed, in one line, for everything that NiftiFile and the checks in check_image_file.h refuse or
/// ITK cannot read; kLimit when out of memory. Cost: one copy in memory. Safe to call from several threads on
/// different files.
[[nodiscard]] Result<Image> import_image(const std::filesystem::path& path);

/// kFailed, with both values, if two grids differ: in size, or in the positions of their voxels by more than
/// 0.01 voxels.
[[nodiscard]] Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                                           const std::string& name_of_b);

/// Reorders voxels of a source file to the order in which an atlas stores its grid (storage_order).
[[nodiscard]] VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid);

/// Whether voxels have more than one value besides 0 and NaN, unlike a mask.
[[nodiscard]] bool holds_several_values(const VoxelBuffer& voxels);

/// 1 for every voxel that is not 0, in the same order; NaN counts as 0.
[[nodiscard]] std::vector<std::uint8_t> mask_of(const VoxelBuffer& voxels);

}  // namespace splatlas
