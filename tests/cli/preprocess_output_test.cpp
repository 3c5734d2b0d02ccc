// Output paths of splatlas-preprocess and the errors about them.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "format/atlas_writer.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// phantom.atlas in its own folder.
class PreprocessOutput : public testing::Test {
 protected:
  PreprocessOutput() { std::filesystem::copy_file(phantom_atlas(), folder_.file("a.atlas")); }

  ProgramResult run_export(const Words& words) const {
    return run_preprocess(joined({"export", "a.atlas"}, words), folder_.path());
  }
  std::string bytes(const std::string& name) const { return read_bytes(folder_.file(name)); }
  TemporaryFolder folder_;
};

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

/// "@FILE" stands for the words of a file; its atlas has the same bytes.
TEST_F(PreprocessOutput, OptionsComeFromAFile) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  write_bytes(folder_.file("a.args"),
              "# two balls\n--labels " + labels + "\n\n  --title \"Two balls\" --compact\r\n");
  const auto build = [&](const Words& words) {
    return run_preprocess(joined({"build", "-o"}, words), folder_.path());
  };
  ASSERT_EQ(build({"x.atlas", "@a.args"}).status, 0);
  ASSERT_EQ(build({"y.atlas", "--labels", labels, "--title", "Two balls", "--compact"}).status, 0);
  EXPECT_EQ(bytes("x.atlas"), bytes("y.atlas"));
  const ProgramResult missing = build({"z.atlas", "@missing.args"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("missing.args: no such file"));
}

/// Findings are no failure. Reports are those of a build, without notes.
TEST_F(PreprocessOutput, CheckTellsFindingsAndMeasures) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  const auto parsed = [&](const std::string& name) { return nlohmann::json::parse(bytes(name)); };
  ASSERT_EQ(run_preprocess({"build", "-o", "x.atlas", "--labels", labels, "--json", "b.json", "--report",
                            "b.html", "--progress", "none"},
                           folder_.path())
                .status,
            0);
  const ProgramResult result =
      run_preprocess({"check", "x.atlas", "--json", "c.json", "--report", "c.html"}, folder_.path());
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("x.atlas: 2 structures, 2 findings\nunnamed-labels: \"Label 1\": label"));
  nlohmann::json report = parsed("b.json");
  EXPECT_EQ(report.erase("notes"), 1u);
  EXPECT_EQ(parsed("c.json"), report);
  EXPECT_EQ(report["structures"][0]["name"], "Label 1");
  EXPECT_EQ(report["structures"][0]["pieces"], 1);
  EXPECT_EQ(report["findings"][1]["structures"], nlohmann::json({"Label_2"}));
  for (const char* name : {"b.html", "c.html"}) {
    EXPECT_THAT(bytes(name), HasSubstr("<td>2</td>"));
    EXPECT_THAT(bytes(name), HasSubstr("<circle"));
  }
  const ProgramResult damaged = run_preprocess({"check", labels, "--json", "d.json"}, folder_.path());
  EXPECT_EQ(damaged.status, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("d.json")));
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
  const ProgramResult result = run_export({"--names", "n.csv", "--tree", "t.txt", "--labels", "masks/"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("t.txt: 2.306e+18 paths"));
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(folder_.names(), ElementsAre("a.atlas"));
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

/// Standard output has the bytes of a file, and standard input builds what that file builds.
TEST_F(PreprocessOutput, LabelsGoThroughPipes) {
  for (const char* file : {"l.nrrd", "l.nii", "l.nii.gz"}) {
    SCOPED_TRACE(file);
    ASSERT_EQ(run_export({"--labels", file}).status, 0);
    const Words words{"build", "--progress", "none", "--labels"};
    ASSERT_EQ(run_preprocess(joined(words, {file, "-o", "x.atlas"}), folder_.path()).status, 0);
    const std::string piped = std::string(R"(TMPDIR=. exec "$0" "$@" <)") + file;
    const ProgramResult built = run_by_shell(
        piped.c_str(), joined({SPLATLAS_PREPROCESS}, joined(words, {"-", "-o", "y.atlas"})), folder_.path());
    EXPECT_EQ(built.status, 0) << built.err;
    EXPECT_TRUE(bytes("x.atlas") == bytes("y.atlas"));
  }
  const ProgramResult stream = run_export({"--labels", "-", "--names", "n.csv"});
  EXPECT_TRUE(stream.out == bytes("l.nrrd")) << stream.err;
  const ProgramResult none =
      run_by_shell(R"(echo none | TMPDIR=. exec "$0" build --labels - -o z.atlas --progress none)",
                   {SPLATLAS_PREPROCESS}, folder_.path());
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("/standard input.nii: "));
  EXPECT_THAT(folder_.names(), ElementsAre("a.atlas", "l.nii", "l.nii.gz", "l.nrrd", "n.csv", "x.atlas",
                                           "y.atlas"));  // and no folder of the input
}

TEST_F(PreprocessOutput, UnwrittenStandardOutputIsAFailure) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  for (const Words& words : {Words{"export", "a.atlas", "--labels", "l.nii.gz"},
                             {"build", "-o", "b.atlas", "--labels", labels, "--progress", "none"},
                             {"--help"},
                             {"--version"}}) {
    const ProgramResult result =
        run_by_shell(kFullDevice, joined({SPLATLAS_PREPROCESS}, words), folder_.path());
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr("No space left on device"));
  }
}

}  // namespace
}  // namespace splatlas
