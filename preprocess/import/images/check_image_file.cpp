#include "preprocess/import/images/check_image_file.h"

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/import_error.h"

namespace splatlas {

Result<ImageFormat> image_format(const std::filesystem::path& path) {
  const std::string name = to_lower(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return ImageFormat::kNifti;
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return ImageFormat::kNrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return ImageFormat::kMetaImage;
  return bad_file(path, "is of no known type; volumes end in .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd");
}

tl::unexpected<Error> bad_pixel_type(const std::filesystem::path& path, std::string_view type) {
  return bad_file(path, "has pixels of {}; 8, 16 and 32-bit integers, float and double are read", type);
}

Result<void> check_one_volume(const std::filesystem::path& path, std::int64_t volumes) {
  if (volumes == 1) return {};
  return bad_file(path, "holds {} volumes; give one volume a file", volumes);
}

}  // namespace splatlas
