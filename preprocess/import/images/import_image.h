// Importer of volume files, and their resampling to other grids.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/membership_volume.h"

namespace splatlas {

/// A format of volumes and label maps. A new one is a reader and a line in import_image.cpp.
struct ImageFormatEntry {
  const char* name;  ///< for messages: "NIfTI"
  bool (*recognises)(const std::filesystem::path& file_or_folder);
  Result<SourceImage> (*read)(const std::filesystem::path& file_or_folder, const ImageOptions& options);
};

/// The format of a file or a folder; null for others.
[[nodiscard]] const ImageFormatEntry* find_image_format(const std::filesystem::path& file_or_folder);

/// The other file of an image of two: the pixels that a header names, or the header of an .img. Empty or the
/// path itself for others. Reads a header of NRRD or MetaImage.
[[nodiscard]] std::filesystem::path other_file(const std::filesystem::path& path);

/// Reads a file or a folder in a child, so that no file brings this process down (run_isolated.h). kFailed
/// for what no format recognises; the message leads on.
[[nodiscard]] Result<SourceImage> read_image(const std::filesystem::path& file_or_folder,
                                             const ImageOptions& options);

/// One volume: voxels in the grid of the file, i fastest.
struct Image {
  Grid grid;  ///< LPS
  VoxelBuffer voxels;
  std::size_t frame_of_reference = 0;  ///< as of SourceImage
};

/// Reads one volume of any format, in a child. A 2-D image is a volume of one slice. kUsage
/// for files of several volumes without `options.component`, and for a component that the file does not have;
/// errors of the reader. Adds the reader's notes to `notes`. Call it while this process has one thread.
[[nodiscard]] Result<Image> import_image(const std::filesystem::path& path, const ImageOptions& options,
                                         Notes& notes);
[[nodiscard]] Result<Image> import_image(const std::filesystem::path& path);

/// True if two grids have the same voxels, in whatever order of axes, within 0.01 voxels.
[[nodiscard]] bool have_same_voxels(const Grid& a, const Grid& b);

/// kFailed, with both values, if two grids differ in size, or in voxels' positions by over 0.01 voxels.
[[nodiscard]] Result<void> check_same_grid(const Grid& a, const std::string& name_of_a, const Grid& b,
                                           const std::string& name_of_b);

/// Reorders voxels of a source file to the atlas's storage order (storage_order()).
[[nodiscard]] VoxelBuffer to_storage_order(VoxelBuffer voxels, const Grid& source_grid);

/// Binary mask in the same order: 1 for every voxel that is not 0 or NaN.
[[nodiscard]] std::vector<std::uint8_t> mask_of(const VoxelBuffer& voxels);

/// Of every layer, the voxels of `source` that lie nearest to the voxels of `grid`; 0 beyond `source`.
[[nodiscard]] VoxelBuffer resample_nearest(const VoxelBuffer& voxels, const Grid& source, const Grid& grid);

/// Trilinear values at the voxels of `grid`, rounded for integers; beyond the image its least. On all cores.
[[nodiscard]] VoxelBuffer resample_linear(const Image& image, const Grid& grid);

/// Fraction of the voxels of `grid` that lie within `other`, estimated on a lattice of 32^3 points.
[[nodiscard]] double overlap(const Grid& grid, const Grid& other);

/// The voxels around a grid that it lacks to hold another one, in storage order; nullopt unless the voxels of
/// both lie on one lattice.
[[nodiscard]] std::optional<Margin> margin_around(const Grid& grid, const Grid& other);

/// The smallest grid that holds the voxels of both; nullopt unless they lie on one lattice, or for a grid
/// much larger than both.
[[nodiscard]] std::optional<Grid> union_of(const Grid& a, const Grid& b);

}  // namespace splatlas
