// Image formats, and checks of image files before ITK reads them.
//
// ITK's readers accept truncated MetaImage files, follow detached headers to any file of the machine, replace
// invalid spacings silently, and abort on a NaN in an orientation.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "format/result.h"

namespace splatlas {

enum class ImageFormat { kNifti, kNrrd, kMetaImage };

/// Whether a geometry may hold the number: 0, or from 1e-37 to 1e9 in magnitude. ITK's linear algebra aborts
/// on NaN, loops for ever on 1e38, and complains on standard error about 1e-40.
[[nodiscard]] inline bool is_plausible(double x) {
  return x == 0 || (std::abs(x) > 1e-37 && std::abs(x) <= 1e9);
}

/// The format by the file's ending: .nii, .nii.gz; .nrrd, .nhdr; .mha, .mhd. kFailed for any other.
[[nodiscard]] Result<ImageFormat> image_format(const std::filesystem::path& path);

/// Checks a regular NRRD or MetaImage file. kFailed for another format, fewer voxels than promised, spacings
/// that are not positive, a geometry that is not plausible, 64-bit or vector pixels, more than three
/// dimensions, and pixels outside the file's folder. Cost: reads the header, and decompresses compressed
/// pixels once in constant memory to find damage. NIfTI files are checked as they are read (NiftiFile).
[[nodiscard]] Result<void> check_nrrd_file(const std::filesystem::path& path);
[[nodiscard]] Result<void> check_meta_image_file(const std::filesystem::path& path);

// Errors of all formats.
[[nodiscard]] tl::unexpected<Error> bad_pixel_type(const std::filesystem::path& path, std::string_view type);
[[nodiscard]] Result<void> check_one_volume(const std::filesystem::path& path, std::int64_t volumes);

}  // namespace splatlas
