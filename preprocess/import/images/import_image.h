// Reads one volume file through ITK: pixel type and geometry as they are.
#pragma once

#include <filesystem>
#include <string>

#include "format/grid.h"
#include "format/voxel_type.h"

namespace splatlas {

/// One volume: voxels in the grid of the file, i fastest.
struct Image {
  Grid grid;  ///< LPS, as ITK gives it
  VoxelBuffer voxels;
};

/// Reads NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr) or MetaImage (.mha, .mhd). A 2-D image is a volume of one
/// slice, a fourth dimension must have size 1. NIfTI's scl_slope and scl_inter are applied, which makes
/// floats. kFailed, in one line, for everything that check_image_file refuses and whatever ITK cannot read;
/// kLimit when memory does not suffice. Cost: one copy in memory. Safe to call from several threads on
/// different files.
[[nodiscard]] Result<Image> import_image(const std::filesystem::path& path);

/// Refuses two files whose grids differ: in size, or in where their voxels are by more than a hundredth of a
/// voxel. The message gives both values.
[[nodiscard]] Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                                           const std::string& name_of_b);

/// Voxels in the grid of a source file, in the order in which an atlas stores that grid (storage_order).
[[nodiscard]] VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid);

/// Whether voxels have more than one value besides 0 and NaN: then they are more than a mask.
[[nodiscard]] bool holds_several_values(const VoxelBuffer& voxels);

/// 1 where a voxel is not 0 (a NaN is 0), in the order that the voxels are in.
[[nodiscard]] std::vector<std::uint8_t> mask_of(const VoxelBuffer& voxels);

}  // namespace splatlas
