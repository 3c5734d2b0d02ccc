// Fuzz target: the checks of untrusted image files ahead of ITK.
// Input: a byte of choices, then the file.
#include <array>
#include <cstdint>
#include <string>

#include "preprocess/import/images/check_image_file.h"
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/scratch_file.h"

namespace splatlas {
namespace {

void fuzz(FuzzInput input) {
  static const std::array<std::string, 6> kNames{"image.nii",  "image.nii.gz", "image.nrrd",
                                                 "image.nhdr", "image.mha",    "image.mhd"};
  const auto path = write_input_file(kNames[input.below(kNames.size())], input.rest());
  const CostLimit limit;
  const auto sound = check_image_file(path);
  if (!sound) require_error(sound.error(), {ErrorCode::kFailed});
}

}  // namespace
}  // namespace splatlas

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splatlas::fuzz({data, size});
  return 0;
}
