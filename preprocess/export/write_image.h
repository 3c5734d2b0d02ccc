// Writer of volume files, through ITK.
#pragma once

#include <filesystem>

#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// Output format by file extension; kUsage for unknown extensions and formats with two files.
[[nodiscard]] Result<ImageFormat> writable_image_format(const std::filesystem::path& path);

/// Writes .nii, .nii.gz, .nrrd or .mha, atomically. Reads the file back and compares before the rename: ITK's
/// writers do not detect a full disk, and some formats cannot represent every geometry.
[[nodiscard]] Result<void> write_image(const Image& image, const std::filesystem::path& path);

}  // namespace splatlas
