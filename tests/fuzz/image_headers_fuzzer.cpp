// Fuzz target: untrusted image files, as far as they are read without ITK.
// Input: a byte of choices, then the file.
#include <array>
#include <string>
#include <vector>

#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/nifti_file.h"
#include "preprocess/import/images/read_deflated.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/scratch_file.h"

namespace splatlas {
namespace {

Result<void> check_image_file(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const ImageFormat format, image_format(path));
  if (format != ImageFormat::kNifti) {
    SPLATLAS_ASSIGN_OR_RETURN(const PixelData pixels, format == ImageFormat::kNrrd
                                                          ? check_nrrd_file(path)
                                                          : check_meta_image_file(path));
    if (!pixels.is_deflated) return {};
    std::vector<std::byte> bytes;
    return read_deflated(pixels.file, pixels.start, pixels.bytes, bytes);
  }
  SPLATLAS_ASSIGN_OR_RETURN(NiftiFile file, NiftiFile::open(path));
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer voxels, file.read_voxels());
  require(!voxels.bytes.empty(), "an image without voxels");
  return {};
}

}  // namespace

void fuzz(FuzzInput input) {
  static const std::array<std::string, 6> kNames{"image.nii",  "image.nii.gz", "image.nrrd",
                                                 "image.nhdr", "image.mha",    "image.mhd"};
  const auto path = write_input_file(kNames[input.below(kNames.size())], input.rest());
  const auto sound = check_image_file(path);
  if (!sound) require_error(sound.error(), {ErrorCode::kFailed});
}

}  // namespace splatlas
