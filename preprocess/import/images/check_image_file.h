// Image formats, and checks of image files before ITK reads them.
//
// ITK's readers accept truncated MetaImage files and follow detached headers to any file of the machine. They
// replace invalid spacings silently, and abort on a NaN in an orientation.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "format/result.h"

namespace splatlas {

enum class ImageFormat { kNifti, kNrrd, kMetaImage };

/// True for numbers that are valid in a geometry: 0, or a magnitude from 1e-37 to 1e9. ITK's linear algebra
/// aborts on NaN, does not terminate on 1e38, and prints warnings about 1e-40.
[[nodiscard]] inline bool is_plausible(double x) {
  return x == 0 || (std::abs(x) > 1e-37 && std::abs(x) <= 1e9);
}

/// The format by the file's ending: .nii, .nii.gz; .nrrd, .nhdr; .mha, .mhd. kFailed for any other.
[[nodiscard]] Result<ImageFormat> image_format(const std::filesystem::path& path);

/// Checks a regular NRRD or MetaImage file. kFailed for:
///   - another format, 64-bit or vector pixels, or more than three dimensions,
///   - spacings that are not positive, or numbers that are invalid in a geometry,
///   - fewer voxels than the header declares, or pixels outside the file's folder.
/// Cost: reads the header, and decompresses compressed pixels once in constant memory to find damage.
/// NiftiFile checks NIfTI files.
[[nodiscard]] Result<void> check_nrrd_file(const std::filesystem::path& path);
[[nodiscard]] Result<void> check_meta_image_file(const std::filesystem::path& path);

// Errors of all formats.
[[nodiscard]] tl::unexpected<Error> bad_pixel_type(const std::filesystem::path& path, std::string_view type);
[[nodiscard]] Result<void> check_one_volume(const std::filesystem::path& path, std::int64_t volumes);

}  // namespace splatlas
