// Atlases of one brain in all 48 axis orders and directions.
// Needs SPLATLAS_TEST_DATA, a folder with nifti-orient48 (one NIfTI file per order). tests/preprocess tests
// the same with synthetic volumes.

#include <cmath>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/programs.h"
#include "tests/cli/read_pixels.h"

namespace splatlas {
namespace {

/// The parts of `info --json` that do not depend on the axis order of the source.
nlohmann::json content(const std::string& atlas) {
  const ProgramResult result = run_player({"info", atlas, "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  nlohmann::json info = nlohmann::json::parse(result.out);
  // Every file rounds another corner of the volume to 32-bit floats.
  for (nlohmann::json& origin : info["storage_grid"]["origin_lps_mm"]) {
    origin = std::round(origin.get<double>() * 1e4) / 1e4;
  }
  return {info["storage_grid"], info["classes"], info["axes"], info["structures"]};
}

TEST(Orientation, All48OrdersGiveTheSameAtlasAndPictures) {
  const char* data = std::getenv("SPLATLAS_TEST_DATA");
  if (data == nullptr) return;
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(data) / "nifti-orient48")) {
    if (entry.path().string().ends_with(".nii.gz")) files.push_back(entry.path());
  }
  ASSERT_EQ(files.size(), 48u);

  const TemporaryFolder folder;
  nlohmann::json first_content;
  std::map<std::string, std::vector<float>> first_pictures;
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file.filename().string());
    const ProgramResult build =
        run_preprocess({"build", "-o", "a.atlas", "--volume", file.string(), "--segment",
                        "Brain=threshold:otsu", "--progress", "none", "--level", "1"},
                       folder.path());
    ASSERT_EQ(build.status, 0) << build.err;
    const nlohmann::json this_content = content(folder.file("a.atlas"));
    if (first_content.is_null()) first_content = this_content;
    EXPECT_EQ(this_content, first_content);
    for (const std::string view : {"anterior", "posterior", "left", "right", "superior", "inferior"}) {
      const ProgramResult render = run_player({"render", "a.atlas", "-o", "v.exr", "--view", view, "--select",
                                               "Brain:both(opacity=0.5)", "--size", "128x128"},
                                              folder.path());
      ASSERT_EQ(render.status, 0) << render.err;
      const std::vector<float> picture = read_pixels(folder.file("v.exr"));
      const std::vector<float>& first = first_pictures.try_emplace(view, picture).first->second;
      ASSERT_EQ(picture.size(), std::size_t{4} * 128 * 128);
      EXPECT_LT(largest_difference(picture, first), 1e-4f) << view;
    }
  }
}

}  // namespace
}  // namespace splatlas
