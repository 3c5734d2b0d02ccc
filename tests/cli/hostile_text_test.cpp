// Texts of files, file names and command lines that imitate or disturb the output of the programs.

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "format/text/ascii_text.h"
#include "tests/cli/hostile_atlas.h"
#include "tests/cli/phantom_atlas.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

/// File names with control characters, with characters that reorder or hide text, and without UTF-8.
const std::vector<std::string> kHostileFiles{"\x1b[2Ja",
                                             "a\nnote: forged",
                                             "a\tb",
                                             "a\r\x7f",
                                             "a\xc2\x9b"
                                             "1m",
                                             "a\xe2\x80\x8f",
                                             "a\xd8\x9c",
                                             "a\xe2\x80\xa8",
                                             "a\xe2\x80\xaegpj",
                                             "a\xe2\x81\xa6",
                                             "a\xef\xbb\xbf",
                                             "a\xff"};

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
  expect_safe(info, 8 + static_cast<std::ptrdiff_t>(kHostileTexts.size()));
  EXPECT_THAT(info.out, HasSubstr("\ntitle     Left?note: forgedLeft?thgiR\n"));
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

TEST_F(HostileText, OfAnAtlasStaysInTheLineOfAnError) {
  write_hostile_atlas(folder.file("a.atlas"));
  for (const std::string name : {"Left", "Lef", "*Left*", "\x1b[2J", "\"a\nb\""}) {
    const ProgramResult result = run_player(
        {"render", "a.atlas", "-o", "x.png", "--size", "8x8", "--select", name + "x"}, folder.path());
    EXPECT_THAT(result.status, AnyOf(2, 4)) << name;
    EXPECT_EQ(lines_of(result.err), 1) << result.err;
    EXPECT_EQ(result.err, printable_lines(result.err));
    EXPECT_THAT(result.err, Not(HasSubstr("\t")));
  }
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
    EXPECT_THAT(exported.out, StartsWith(printable(name) + "/: "));
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

/// Exports a mask per id of an atlas.
ProgramResult export_masks(const std::vector<std::string>& ids, const TemporaryFolder& folder) {
  write_bytes(folder.file("a.atlas"), value_or_throw(encode_atlas(hostile_content(ids, ids))));
  return run_preprocess({"export", "a.atlas", "--labels", "masks/"}, folder.path());
}

TEST_F(HostileText, OfIdsMakesNoHostileFileNames) {
  const std::string longest(200, 'x');
  const ProgramResult exported =
      export_masks({".", "..", "-rf", "Safe.name-1", "CON", "_con", longest + "y", longest}, folder);
  expect_safe(exported, 1);
  EXPECT_EQ(exported.out, "masks/: 8 masks\n");
  EXPECT_EQ(
      exported.err,
      "note: masks/: 5 ids are no safe file names: \".\" is __.nii.gz, \"..\" is _._.nii.gz, \"-rf\" is "
      "_-rf.nii.gz, \"CON\" is _CON_2.nii.gz, \"" +
          longest.substr(0, 80) + "...\" is " + longest.substr(2) + "_2.nii.gz\n");
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder.path() / "masks"))
    files.push_back(entry.path().filename().string());
  EXPECT_THAT(files, UnorderedElementsAre("__.nii.gz", "_._.nii.gz", "_-rf.nii.gz", "Safe.name-1.nii.gz",
                                          "_CON_2.nii.gz", "_con.nii.gz", longest.substr(2) + "_2.nii.gz",
                                          longest + ".nii.gz"));
}

TEST_F(HostileText, OfManyIdsIsCounted) {
  std::vector<std::string> ids;
  for (int n = 0; n < 13; ++n) ids.push_back("-" + std::to_string(n));
  const ProgramResult exported = export_masks(ids, folder);
  expect_safe(exported, 1);
  EXPECT_THAT(exported.err,
              StartsWith("note: masks/: 13 ids are no safe file names: \"-0\" is _-0.nii.gz, "));
  EXPECT_THAT(exported.err, EndsWith("\"-9\" is _-9.nii.gz and 3 more\n"));
}

TEST_F(HostileText, OfSafeIdsNeedsNoNote) {
  const ProgramResult exported = export_masks({"Putamen_L", "a.b"}, folder);
  expect_safe(exported, 1);
  EXPECT_EQ(exported.err, "");
}

TEST_F(HostileText, OfCommandLines) {
  const std::vector<Words> player{{"info", "\x1b[2J"},
                                  {"info", "a", "\nb"},
                                  {"\xe2\x80\xae"},
                                  {"--\x1b[2J\n"},
                                  {"render", "a", "-o", "x.\n"},
                                  {"render", "a", "-o", "x.png", "--size", "\xe2\x80\x8f"},
                                  {"render", "a", "-o", "x.png", "--select", "(\x1b\n"}};
  const std::vector<Words> preprocess{{"\x1b[2J"},
                                      {"build", "-o", "a\n.atlas", "--labels", "\xe2\x80\xae"},
                                      {"build", "-o", "x", "--labels", "y", "--segment", "\n=\x1b"},
                                      {"build", "-o", "x", "--labels", "y", "--mesh", "\n=\x1b"},
                                      {"build", "-o", "x", "--labels", "y", "--title", "\x1b"},
                                      {"export", "\xe2\x80\xa8", "--labels", "a.\n"}};
  const auto check = [](const ProgramResult& result) {
    EXPECT_THAT(result.status, AnyOf(1, 2));
    EXPECT_EQ(lines_of(result.err), 1) << result.err;
    EXPECT_EQ(result.err, printable_lines(result.err));
    EXPECT_EQ(result.out, "");
  };
  for (const Words& words : player) check(run_player(words, folder.path()));
  for (const Words& words : preprocess) check(run_preprocess(words, folder.path()));
}

}  // namespace
}  // namespace splatlas
