// Writer of volume files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "format/io/output_file.h"
#include "preprocess/import/images/import_image.h"

namespace splatlas {

enum class ImageFormat { kNifti, kNrrd, kMetaImage };

/// Output format by file extension; kUsage for unknown extensions and formats with two files.
[[nodiscard]] Result<ImageFormat> writable_image_format(const std::filesystem::path& path);

/// Writes .nii, .nii.gz, .nrrd or .mha, up to commit_files(). The voxels have a type and fill the grid, which
/// is valid. kFailed, before a file exists, for a geometry that the format cannot hold (image_headers.h).
/// Cost: compresses in pieces; .mha keeps the compressed voxels in memory.
[[nodiscard]] Result<OutputFile> write_image(const Image& image, const std::filesystem::path& path);

/// The file of a mask, compressed fast: its runs are long. Errors as of write_image(). Thread-safe.
[[nodiscard]] Result<std::vector<std::byte>> encode_mask_file(const Image& mask,
                                                              const std::filesystem::path& path);

}  // namespace splatlas
