// Writes one volume file through ITK.
#pragma once

#include <filesystem>

#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// By the ending of a file that is to be written; kUsage for endings of unknown types, and of formats that
/// take two files.
[[nodiscard]] Result<ImageFormat> writable_image_format(const std::filesystem::path& path);

/// Writes .nii, .nii.gz, .nrrd or .mha, by the ending of `path`; whole or not at all. The file is read back
/// and compared before it gets its name: ITK's writers do not notice a full disk, and not every format holds
/// every geometry.
[[nodiscard]] Result<void> write_image(const Image& image, const std::filesystem::path& path);

}  // namespace splatlas
