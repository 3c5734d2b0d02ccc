#include "preprocess/import/images/check_image_file.h"

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<ImageFormat> image_format(const std::filesystem::path& path) {
  const std::string name = to_lower(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return ImageFormat::kNifti;
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return ImageFormat::kNrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return ImageFormat::kMetaImage;
  return fail(ErrorCode::kFailed,
              fmt::format("{}: is of no known type; volumes end in .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd",
                          path.string()));
}

Result<void> check_image_file(const std::filesystem::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, image_format(path));
  switch (format) {
    case ImageFormat::kNifti: return check_nifti_file(path);
    case ImageFormat::kNrrd: return check_nrrd_file(path);
    case ImageFormat::kMetaImage: break;
  }
  return check_meta_image_file(path);
}

}  // namespace splatlas
