// Output paths of splatlas-preprocess and the errors about them.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>

#include "format/atlas_writer.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/support/file_bytes.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// phantom.atlas in its own folder.
class PreprocessOutput : public testing::Test {
 protected:
  PreprocessOutput() { std::filesystem::copy_file(phantom_atlas(), folder_.file("a.atlas")); }

  ProgramResult run_export(const Words& words) const {
    return run_preprocess(joined({"export", "a.atlas"}, words), folder_.path());
  }
  /// Expects one line that contains `text`, and no new file.
  void refuses(const Words& words, int status, const std::string& text) const {
    const std::vector<std::string> before = folder_.names();
    const ProgramResult result = run_export(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_EQ(folder_.names(), before);
  }
  std::string bytes(const std::string& name) const { return read_bytes(folder_.file(name)); }
  ProgramResult run_on(const char* script, const Words& words) const {
    return run_by_shell(script, joined({SPLATLAS_PREPROCESS}, words), folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(PreprocessOutput, NoOutputIsAnotherOne) {
  namespace fs = std::filesystem;
  refuses({"--surface", "Sphere 1=s.stl", "--surface", "Sphere 2=s.stl"}, 2, "s.stl");
  fs::create_symlink("s.stl", folder_.file("link.stl"));  // dangling link
  refuses({"--surface", "Sphere 1=s.stl", "--surface", "Sphere 2=link.stl"}, 2, "link.stl");
  std::ofstream(folder_.file("one.nii")) << "kept";
  fs::create_hard_link(folder_.file("one.nii"), folder_.file("two.nii"));
  refuses({"--labels", "one.nii", "--volume", "two.nii"}, 2, "two.nii");
  EXPECT_EQ(bytes("one.nii"), "kept");
  refuses({"--labels", "masks/", "--surface", "Sphere 1=masks/s.stl"}, 2, "folder of masks");
}

TEST_F(PreprocessOutput, NoOutputIsTheAtlas) {
  const std::string before = bytes("a.atlas");
  std::filesystem::create_symlink("a.atlas", folder_.file("link.nii"));
  std::filesystem::create_hard_link(folder_.file("a.atlas"), folder_.file("hard.nii"));
  refuses({"--labels", "link.nii"}, 2, "link.nii");
  refuses({"--volume", "hard.nii"}, 2, "hard.nii");
  EXPECT_EQ(bytes("a.atlas"), before);
}

TEST_F(PreprocessOutput, StrictTellsTheWarningOnce) {
  write_bytes(folder_.file("one.txt"), "1 Ball\n");
  const std::string labels = phantom_folder().file("labels.nrrd"), told = "1 label has no name";
  const ProgramResult result =
      run_preprocess({"build", "--strict", "--labels", labels, "--names", "one.txt", "-o", "x.atlas",
                      "--json", "x.json", "--report", "x.html", "--progress", "none"},
                     folder_.path());
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(folder_.names(), ElementsAre("a.atlas", "one.txt"));
  EXPECT_THAT(result.err, HasSubstr("splatlas-preprocess: --strict: " + told));
  EXPECT_EQ(result.err.find(told), result.err.rfind(told));
}

TEST_F(PreprocessOutput, AReportGoesOverNoTransform) {
  std::ofstream(folder_.file("moved.txt")) << "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::string before = bytes("moved.txt");
  for (const char* const option : {"--json", "--report", "-o"}) {
    Words words{"build", "--mesh", "A=a.stl,transform=moved.txt", "--progress", "none", option, "moved.txt"};
    if (option != std::string("-o")) words = joined(words, {"-o", "x.atlas"});
    const ProgramResult result = run_preprocess(words, folder_.path());
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("moved.txt: is an input"));
    EXPECT_EQ(bytes("moved.txt"), before);
  }
}

TEST_F(PreprocessOutput, UnknownEndingsAreWrongUsageBeforeAnythingIsRead) {
  std::ofstream(folder_.file("a.atlas"), std::ios::trunc) << "no atlas";
  refuses({"--labels", "x"}, 2, "no known type");
  refuses({"--labels", "x\ny.txt"}, 2, "x?y.txt");
  refuses({"--labels", "x.nii"}, 3, "a.atlas");
}

TEST_F(PreprocessOutput, UnwritableOutputsAreReportedBeforeAnythingIsWritten) {
  std::filesystem::create_directory(folder_.file("full"));
  std::ofstream(folder_.file("full/file")) << "kept";
  refuses({"--labels", "l.nii.gz", "--volume", "v.mha", "--surface", "Sphere 1=full/file/s.stl"}, 1,
          "there is no folder");
  refuses({"--labels", "full/", "--volume", "v.mha"}, 1, "not an empty folder");
}

TEST_F(PreprocessOutput, AFailureLeavesNoFile) {
  constexpr StructureIndex kLevels = 60;  // of two groups each, with 2^60 paths
  TestVolume volume;
  volume.grid.size = {2, 2, 2};
  for (StructureIndex n = 0; n < 2 * kLevels; ++n) {
    volume.structures.push_back({"s" + std::to_string(n), {}});
    if (n >= 2) volume.structures.back().parents = {n / 2 * 2 - 2, n / 2 * 2 - 1};
  }
  volume.structures.back().mask = box_mask(volume.grid.size, {0, 0, 0}, {0, 0, 0});
  write_bytes(folder_.file("a.atlas"), value_or_throw(encode_atlas(make_content(volume))));
  refuses({"--names", "n.csv", "--tree", "t.txt", "--labels", "masks/"}, 1, "t.txt: 2.306e+18 paths");
}

/// Damaged values do not keep labels and surfaces from being written.
TEST_F(PreprocessOutput, DamageOmitsTheFilesThatNeedTheDamagedPart) {
  std::string damaged = bytes("a.atlas");
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  std::ofstream(folder_.file("a.atlas"), std::ios::binary) << damaged;
  const ProgramResult result =
      run_export({"--labels", "l.nrrd", "--volume", "v.nrrd", "--surface", "Sphere 2=s.ply"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(
      result.err,
      "splatlas-preprocess: a.atlas: damaged: checksum of values of classes 3 to 4; v.nrrd is not written\n");
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 2) << result.out;
  EXPECT_THAT(folder_.names(), ElementsAre("a.atlas", "l.nrrd", "s.ply"));
}

TEST_F(PreprocessOutput, DamageNamesAllFilesThatAreNotWritten) {
  std::string damaged = bytes("a.atlas");
  std::uint64_t directory_bytes = 0;
  std::memcpy(&directory_bytes, damaged.data() + 40, sizeof directory_bytes);
  for (std::size_t at = 64 + directory_bytes; at < damaged.size(); ++at)
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
  std::ofstream(folder_.file("a.atlas"), std::ios::binary) << damaged;
  const ProgramResult result =
      run_export({"--labels", "l.nrrd", "--volume", "v.nrrd", "--surface", "Sphere 2=s.ply"});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("; l.nrrd, v.nrrd and s.ply are not written\n"));
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(folder_.names(), ElementsAre("a.atlas"));
}

TEST_F(PreprocessOutput, UnwrittenStandardOutputIsAFailure) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  for (const Words& words : {Words{"export", "a.atlas", "--labels", "l.nii.gz"},
                             {"build", "-o", "b.atlas", "--labels", labels, "--progress", "none"},
                             {"--help"},
                             {"--version"}}) {
    const ProgramResult result = run_on(kFullDevice, words);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr("No space left on device"));
  }
}

}  // namespace
}  // namespace splatlas
