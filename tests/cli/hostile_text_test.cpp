// Texts of files, file names and command lines that imitate or disturb the output of the programs.

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "format/text/ascii_text.h"
#include "tests/cli/hostile_atlas.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// File names with control characters, with characters that reorder or hide text, and without UTF-8.
const std::vector<std::string> kHostileFiles{"\x1b[2Ja", "a\nnote: forged", "a\xe2\x80\xaegpj", "a\xff"};

std::ptrdiff_t lines_of(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

/// Expects a success whose output has no unsafe character other than the line feeds of `lines` lines.
void expect_safe(const ProgramResult& result, std::ptrdiff_t lines) {
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, printable_lines(result.out));
  EXPECT_EQ(lines_of(result.out), lines) << result.out;
  EXPECT_EQ(result.err, printable_lines(result.err));
  EXPECT_THAT(result.out + result.err, Not(HasSubstr("\t")));
}

struct HostileText : testing::Test {
  TemporaryFolder folder;
};

TEST_F(HostileText, OfAnAtlasKeepsTheLayoutOfInfo) {
  write_hostile_atlas(folder.file("a.atlas"));
  const ProgramResult info = run_player({"info", "a.atlas"}, folder.path());
  expect_safe(info, 10 + static_cast<std::ptrdiff_t>(kHostileTexts.size()));
  EXPECT_THAT(info.out, HasSubstr("\ntitle     Left?note: forgedLeft?thgiR\n"));
  EXPECT_THAT(info.out, HasSubstr("\nscenes    \"Left?note: forged\", "));
  EXPECT_THAT(info.out, HasSubstr("\nLeft?note: forged  "));
}

TEST_F(HostileText, OfAnAtlasIsExactInJson) {
  write_hostile_atlas(folder.file("a.atlas"));
  const ProgramResult info = run_player({"info", "a.atlas", "--json"}, folder.path());
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(info.out, printable_lines(info.out));
  EXPECT_THAT(info.out, AllOf(HasSubstr("\\u200f"), HasSubstr("\\u061c"), HasSubstr("\\udb40\\udc41")));
  const nlohmann::json json = nlohmann::json::parse(info.out);
  for (std::size_t n = 0; n < kHostileTexts.size(); ++n) {
    EXPECT_EQ(json["structures"][n]["name"], kHostileTexts[n]);
    EXPECT_EQ(json["scenes"][n]["caption"], kHostileTexts[n]);
  }
  EXPECT_EQ(json["provenance"]["licence"], kHostileTexts[4]);
}

TEST_F(HostileText, OfFileNamesOfThePlayer) {
  for (const std::string& name : kHostileFiles) {
    SCOPED_TRACE(printable(name));
    const std::string atlas = name + ".atlas";
    fs::copy_file(phantom_atlas(), folder.path() / atlas);
    const ProgramResult verify = run_player({"verify", atlas}, folder.path());
    expect_safe(verify, 1);
    EXPECT_THAT(verify.out, StartsWith(printable(atlas) + ": a valid atlas, "));
    const ProgramResult info = run_player({"info", atlas}, folder.path());
    expect_safe(info, lines_of(run_player({"info", phantom_atlas()}).out));
    EXPECT_THAT(info.out, StartsWith(printable(atlas) + ": atlas "));
    const ProgramResult render = run_player(
        {"render", atlas, "-o", name + ".png", "--stats", name + ".json", "--size", "8x8"}, folder.path());
    expect_safe(render, 0);
    EXPECT_TRUE(fs::exists(folder.path() / (name + ".png")));
    EXPECT_TRUE(nlohmann::json::accept(std::ifstream(folder.path() / (name + ".json"))));
  }
}

TEST_F(HostileText, OfFileNamesOfPreprocess) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  for (const std::string& name : kHostileFiles) {
    SCOPED_TRACE(printable(name));
    fs::copy_file(labels, folder.path() / (name + ".nrrd"));
    const std::string atlas = name + ".atlas";
    const ProgramResult build =
        run_preprocess({"build", "-o", atlas, "--labels", name + ".nrrd"}, folder.path());
    expect_safe(build, 1);
    EXPECT_THAT(build.out, StartsWith(printable(atlas) + ": "));
    const ProgramResult exported = run_preprocess(
        {"export", atlas, "--labels", name + "/", "--surface", "Label 1=" + name + ".stl"}, folder.path());
    expect_safe(exported, 2);
    EXPECT_THAT(exported.out, testing::HasSubstr("\n" + printable(name) + "/: "));
  }
}

/// Notes quote names of the command line.
TEST_F(HostileText, OfNotes) {
  const std::string labels = phantom_folder().file("labels.nrrd");
  const ProgramResult build =
      run_preprocess({"build", "-o", "a.atlas", "--labels", labels, "--progress", "none", "--segment",
                      "Le\xe2\x80\x8f"
                      "ft\xe2\x80\xa8note: forged=mask:" +
                          labels},
                     folder.path());
  expect_safe(build, 1);
  EXPECT_THAT(build.err, AllOf(StartsWith("warning: 1 segment"), HasSubstr("Le?ft?note: forged")));
}

}  // namespace
}  // namespace splatlas
