// Writer of volume files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "format/io/output_file.h"
#include "format/result.h"
#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// Everything ahead of the voxels of a NIfTI-1 file, 352 bytes, with ITK's conventions: qform and sform in
/// RAS, both with code 1, in single precision and with orthonormal axes. Sheared axes have an sform alone.
/// kFailed, with `path`, if import_image() would read another grid from them (check_same_grid()), and for
/// more than 32767 voxels along an axis.
[[nodiscard]] Result<std::string> nifti_header(const Grid& grid, VoxelType type,
                                               const std::filesystem::path& path);

enum class ImageFormat { kNifti, kNrrd, kMetaImage };

/// Output format by file extension; kUsage for unknown extensions and formats with two files.
[[nodiscard]] Result<ImageFormat> writable_image_format(const std::filesystem::path& path);

/// Writes .nii, .nii.gz, .nrrd or .mha, up to commit_files(). The voxels have a type and fill the grid, which
/// is valid. kFailed, before a file exists, for a geometry that the format cannot hold (nifti_header()).
/// Cost: compresses in pieces; .mha keeps the compressed voxels in memory.
[[nodiscard]] Result<OutputFile> write_image(const Image& image, const std::filesystem::path& path);

/// The bytes of such a file; NIfTI is compressed fast, for masks, whose runs are long. Errors as of
/// write_image(). Thread-safe.
[[nodiscard]] Result<std::vector<std::byte>> encode_image(const Image& image,
                                                          const std::filesystem::path& path);

}  // namespace splatlas
