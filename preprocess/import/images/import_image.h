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
/// slice; a fourth dimension must have size 1. Applies NIfTI's scl_slope and scl_inter, with floats as
/// result. kFailed, in one line, for files that NiftiFile, check_image_file.h or ITK reject; kLimit when out
/// of memory. Cost: one copy in memory. Thread-safe for different files.
[[nodiscard]] Result<Image> import_image(const std::filesystem::path& path);

/// kFailed, with both values, if two grids differ: in size, or in the positions of their voxels by more than
/// 0.01 voxels.
[[nodiscard]] Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                                           const std::string& name_of_b);

/// Reorders voxels of a source file to the atlas's storage order (storage_order()).
[[nodiscard]] VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid);

/// True if voxels have more than one value besides 0 and NaN, unlike a mask.
[[nodiscard]] bool holds_several_values(const VoxelBuffer& voxels);

/// Binary mask in the same order: 1 for every voxel that is not 0 or NaN.
[[nodiscard]] std::vector<std::uint8_t> mask_of(const VoxelBuffer& voxels);

}  // namespace splatlas
