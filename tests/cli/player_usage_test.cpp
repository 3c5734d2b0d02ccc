// Usage errors of splatlas-player: one clear line each.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/phantom_atlas.h"

namespace splatlas {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Runs the program with `words`: it must fail with `status` and one line that contains `text`, and leave the
/// folder empty.
void expect_refused(const std::vector<std::string>& words, int status, const std::string& text) {
  const TemporaryFolder folder;
  std::vector<std::string> all{SPLATLAS_PLAYER};
  all.insert(all.end(), words.begin(), words.end());
  const ProgramResult result = run_program(all, folder.path());
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_THAT(result.err, StartsWith("splatlas-player: "));
  EXPECT_THAT(result.err, HasSubstr(text));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(PlayerUsage, TellsWhatIsWrong) {
  const std::string atlas = phantom_atlas();
  expect_refused({"render", "missing.atlas", "-o", "x.png"}, 1, "missing.atlas: ");
  expect_refused({"render", phantom_folder().file("labels.nrrd"), "-o", "x.png"}, 3, "not an atlas");
  expect_refused({"render", phantom_folder().path().string(), "-o", "x.png"}, 3, "a folder");
  expect_refused({"render", atlas, "-o", "x.png", "--select", "Spere"}, 4, "Sphere 1");
  expect_refused({"render", atlas, "-o", "x.png", "--select", "\"Sphere 1\":solid"}, 2, "solid");
  expect_refused({"render", atlas, "-o", "x.png", "--select", "\"Sphere 1\"(opacity=2)"}, 2, "opacity");
  expect_refused({"render", atlas, "-o", "x.png", "--select", "\"Sphere 1\"(low=9,high=3)"}, 2,
                 "column 23: low 9 must be below high 3");
  expect_refused({"render", atlas, "-o", "x.bmp"}, 2, ".png, .jpg, .tif or .exr");
  expect_refused({"render", atlas, "-o", "nowhere/x.png"}, 1, "nowhere/x.png: cannot be written");
  expect_refused({"render", atlas, "-o", "x.png", "--size", "0x10"}, 2, "0x10");
  expect_refused({"render", atlas, "-o", "x.png", "--size", "100000x100000"}, 2, "100000x100000");
  expect_refused({"render", atlas, "-o", "x.png", "--size", "32768x32768", "--background", "transparent"}, 2,
                 "2^32");
  expect_refused({"render", atlas, "-o", "x.png", "--size", "10"}, 2, "WIDTHxHEIGHT");
  expect_refused({"render", atlas, "-o", "x.png", "--azimuth", "nan"}, 2, "azimuth");
  expect_refused({"render", atlas, "-o", "x.png", "--zoom", "0"}, 2, "zoom");
  expect_refused({"render", atlas, "-o", "x.png", "--view", "top"}, 2, "superior");
  expect_refused({"render", atlas, "-o", ""}, 2, "--output \"\": must name a file");
  expect_refused({"render", atlas, "-o", "x.png", "--quality", "best"}, 2, "draft, normal or high");
  expect_refused({"render", atlas, "-o", "x.png", "--background", "blue"}, 2,
                 "--background \"blue\": must be #rrggbb or transparent");
  expect_refused({"render", atlas, "-o", "x.png", "--projection", "fisheye"}, 2, "parallel or perspective");
  expect_refused({"render", atlas, "-o", "x.png", "--classify", "never"}, 2, "before or after");
  for (const std::string degrees : {"0", "180", "nan", "-5"}) {
    expect_refused(
        {"render", atlas, "-o", "x.png", "--projection", "perspective", "--field-of-view", degrees}, 2,
        "field of view " + degrees);
  }
  expect_refused({"render", atlas, "-o", "x.png", "--field-of-view", "40"}, 2, "--projection perspective");
  expect_refused({"render", atlas, "-o", "x.png", "--projection", "perspective", "--azimuth", "40",
                  "--field-of-view", "150", "--select", "\"Sphere 1\":surface"},
                 2, "too wide for surfaces");
}

TEST(PlayerUsage, WordsThatSayNothingAreRefused) {
  for (const std::string option :
       {"--size", "--view", "--azimuth", "--elevation", "--zoom", "--projection", "--field-of-view",
        "--classify", "--quality", "--shading", "--depth-cue", "--background", "--threads", "--stats"}) {
    expect_refused({"render", phantom_atlas(), "-o", "x.png", option, ""}, 2, option);
  }
  for (const std::string size :
       {" 10x10", "10x10 ", "10 x10", "10x", "x10", "10x10x", "+10x10", "0x1px", "99999999999x1"}) {
    expect_refused({"render", phantom_atlas(), "-o", "x.png", "--size", size}, 2, "WIDTHxHEIGHT");
  }
  for (const std::string number : {" 1", "1 ", "1,5", "1e", "0x1", "--"}) {
    expect_refused({"render", phantom_atlas(), "-o", "x.png", "--zoom=" + number}, 2, "--zoom");
  }
  for (const std::string threads : {"-1", "1.5", "2000", "two"}) {
    expect_refused({"render", phantom_atlas(), "-o", "x.png", "--threads=" + threads}, 2, "--threads");
    expect_refused({phantom_atlas(), "--threads=" + threads}, 2, "--threads");
  }
}

TEST(PlayerUsage, BytesThatAreNoTextAreEscaped) {
  expect_refused({"render", phantom_atlas(), "-o", "x.png", "--select", "Sph\xff\xfe"}, 4,
                 "\"Sph\\xff\\xfe\"");
  expect_refused({"render", "a\nb\x9b.atlas", "-o", "x.png"}, 1, "a?b\\x9b.atlas: ");
  expect_refused({"render", "a.atlas", "-o", "x.png", "--no\n\xff"}, 2, "--no?\\xff");
}

/// The exact line.
void expect_line(const std::vector<std::string>& words, const std::string& line) {
  std::vector<std::string> all{SPLATLAS_PLAYER};
  all.insert(all.end(), words.begin(), words.end());
  const TemporaryFolder folder;
  const ProgramResult result = run_program(all, folder.path());
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(result.err, "splatlas-player: " + line + "\n");
}

TEST(PlayerUsage, IsExplainedInOneLine) {
  const std::string atlas = phantom_atlas();
  expect_line({}, "no atlas file is given; see splatlas-player --help");
  expect_line({"render"}, "ATLAS is required; see splatlas-player render --help");
  expect_line({"render", atlas}, "--output is required; see splatlas-player render --help");
  expect_line({"info"}, "ATLAS is required; see splatlas-player info --help");
  expect_line({"--no-such-option"},
              "The following argument was not expected: --no-such-option; see splatlas-player --help");
  expect_line({"verify", atlas, atlas},
              "The following argument was not expected: " + atlas + "; see splatlas-player verify --help");
  const std::string no_command =
      "\"rendr\" is no command (render, info, verify) and no atlas file; see splatlas-player --help";
  expect_line({"rendr"}, no_command);
  expect_line({"rendr", atlas}, no_command);
  expect_line({"rendr", atlas, "-o", "x.png"}, no_command);
  expect_line({atlas, "more"}, "The following argument was not expected: more; see splatlas-player --help");
}

TEST(PlayerUsage, HelpTeaches) {
  const ProgramResult help = run_program({SPLATLAS_PLAYER, "render", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*"));
  EXPECT_THAT(help.out, HasSubstr("Exit status"));
}

}  // namespace
}  // namespace splatlas
