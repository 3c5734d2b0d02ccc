// Builds that are refused: names, paths and inputs that do not fit together.
#include <filesystem>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

using testing::HasSubstr;

TEST_F(BuildAtlas, EveryStructureHasANameOfItsOwn) {
  std::mt19937 random(12);
  BuildOptions build_options = options();
  build_options.sources.labels =
      write("labels.nrrd", random_labels(awkward_grid(0), VoxelType::kUInt8, random));
  build_options.sources.meshes = {{"Screw", "missing.stl"}, {"screw", "missing too.stl"}};
  EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--mesh"), HasSubstr("\"screw\"")));
  build_options.sources.meshes.pop_back();
  build_options.sources.segments = {*parse_segment("SCREW =mask:missing.nrrd")};
  EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--segment"), HasSubstr("--mesh")));
  build_options.sources.segments.clear();
  for (const std::string name : {"Label 1", "label 1"}) {
    build_options.sources.meshes = {{name, "missing.stl"}};
    EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--mesh"), HasSubstr("labels.nrrd")));
  }
  for (const std::string& name : {std::string("a\nb"), std::string(201, 'x')}) {
    build_options.sources.meshes = {{name, "missing.stl"}};
    const Result<BuildReport> refused = build_atlas(build_options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
    EXPECT_THAT(refused.error().message, testing::Not(HasSubstr("\n")));
  }
}

TEST_F(BuildAtlas, PathsThatCannotBeFollowedAreToldInOneLine) {
  BuildOptions build_options = options();
  build_options.sources.labels = file(std::string(300, 'x') + ".nii");
  EXPECT_THAT(error_of(build_options), HasSubstr("cannot be read: File name too long"));
  std::filesystem::create_symlink("loop.nii", file("loop.nii"));
  build_options.sources.labels = file("loop.nii");
  EXPECT_THAT(error_of(build_options), HasSubstr("loop.nii: cannot be read: Too many levels of symbolic"));
}

TEST_F(BuildAtlas, NoOutputGoesOverDetachedPixels) {
  write_bytes(file("a.hdr"), nifti_header());
  write_bytes(file("a.nhdr"), nrrd_header("raw", "data file: pixels.raw\n"));
  write_bytes(file("a.mhd"), meta_header("", "pixels.raw"));
  for (const std::string pixels : {"a.img", "pixels.raw"}) write_bytes(file(pixels), RawImage::payload());
  for (const auto& [input, pixels] : {std::pair("a.hdr", "a.img"), std::pair("a.img", "a.hdr"),
                                      std::pair("a.nhdr", "pixels.raw"), std::pair("a.mhd", "pixels.raw")}) {
    BuildOptions build_options = options();
    build_options.output = file(pixels);
    build_options.sources.labels = file(input);
    EXPECT_THAT(build_atlas(build_options), FailsWith(ErrorCode::kUsage, HasSubstr("is an input")));
  }
}

TEST_F(BuildAtlas, RefusesWhatDoesNotFitTogether) {
  std::mt19937 random(6);
  BuildOptions build_options = options();
  build_options.sources.labels =
      write("labels.nrrd", random_labels(awkward_grid(0), VoxelType::kUInt8, random));
  Grid other = awkward_grid(0);
  other.origin_lps_mm[1] += 1e4;
  build_options.sources.volume = write("volume.nrrd", random_volume(other, VoxelType::kUInt8, random));
  EXPECT_THAT(error_of(build_options), HasSubstr("they do not overlap"));
  build_options.sources.resample = ResampleTo::kVolume;
  EXPECT_THAT(error_of(build_options), HasSubstr("they do not overlap"));
  build_options.sources.resample = ResampleTo::kAsk;
  build_options.sources.volume.clear();
  build_options.sources.segments = {*parse_segment("S=mask:" + file("volume.nrrd"))};
  EXPECT_THAT(error_of(build_options), HasSubstr("lies outside the grid"));
}

}  // namespace
}  // namespace splatlas
