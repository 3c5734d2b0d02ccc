// Appearances at an image file's header before ITK does.
//
// ITK's readers take truncated NIfTI and MetaImage files for whole ones, follow detached headers to any file
// of the machine, replace impossible spacings silently, and abort on a NaN in an orientation. Each of these
// is refused here.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "format/result.h"

namespace splatlas {

enum class ImageFormat { kNifti, kNrrd, kMetaImage };

/// A number that a geometry may hold: finite, below a thousand kilometres, and zero rather than next to it.
/// ITK's linear algebra aborts on NaN, loops for ever on 1e38, and complains on standard error about 1e-40.
[[nodiscard]] inline bool is_plausible(double x) {
  return x == 0 || (std::abs(x) > 1e-37 && std::abs(x) <= 1e9);
}

/// By the file's ending: .nii, .nii.gz; .nrrd, .nhdr; .mha, .mhd. kFailed for any other.
[[nodiscard]] Result<ImageFormat> image_format(const std::filesystem::path& path);

/// Refuses what is not a regular file, is not of the format that its ending says, promises more voxels than
/// it holds, has a spacing that is not positive, a geometry that is not plausible, 64-bit or
/// vector pixels, more than three dimensions, or leads to pixels outside its own folder. Cost: reads the
/// header; compressed pixels are decompressed once (not kept), which finds damage as well.
[[nodiscard]] Result<void> check_image_file(const std::filesystem::path& path);

// One per format, called by check_image_file.
[[nodiscard]] Result<void> check_nifti_file(const std::filesystem::path& path);
[[nodiscard]] Result<void> check_nrrd_file(const std::filesystem::path& path);
[[nodiscard]] Result<void> check_meta_image_file(const std::filesystem::path& path);

}  // namespace splatlas
