// Fuzz target: untrusted image files, as read without ITK. Input: a byte of choices, then the file.
#include <array>
#include <string>
#include <vector>

#include "format/result_macros.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/scratch_file.h"

namespace splatlas {
namespace {

Result<void> check_meta_image(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const PixelData pixels, check_meta_image_file(path));
  if (pixels.compression == Compression::kNone) return {};
  std::vector<std::byte> bytes;
  return read_deflated(pixels.file, pixels.start, pixels.bytes, bytes);
}

Result<void> check_image_file(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".mha" || ending == ".mhd") return check_meta_image(path);
  SPLATLAS_ASSIGN_OR_RETURN(const SourceImage image,
                            ending.starts_with(".mg") ? read_mgh(path) : read_nifti(path));
  const auto voxels = static_cast<std::uint64_t>(image.grid.voxels()) * image.layers;
  require(image.voxels.bytes.size() == voxels * bytes_of(image.voxels.type),
          "an image of another size than its grid");
  return {};
}

void fuzz_image_headers(FuzzInput input) {
  static const std::array<std::string, 6> kNames{"image.mgh",    "image.mgz", "image.nii",
                                                 "image.nii.gz", "image.mha", "image.mhd"};
  const auto path = write_input_file(kNames[input.below(kNames.size())], input.rest());
  const auto sound = check_image_file(path);
  if (!sound) require_error(sound.error(), {ErrorCode::kFailed});
}

const FuzzTarget kImageHeaders("image_headers", fuzz_image_headers);

}  // namespace
}  // namespace splatlas
