// Usage errors of splatlas-player: one clear line each.

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/cli/phantom_atlas.h"

namespace splatlas {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Expects that the program fails with `status` and one line, and writes no file. Returns the line.
std::string refusal(const Words& words, int status) {
  const TemporaryFolder folder;
  const ProgramResult result = run_player(words, folder.path());
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_THAT(result.err, StartsWith("splatlas-player: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(folder.names(), IsEmpty());
  return result.err;
}

/// The same for a picture of the phantom with these options.
std::string refused_picture(const Words& options, int status = 2) {
  return refusal(joined({"render", phantom_atlas(), "-o", "x.png"}, options), status);
}

TEST(PlayerUsage, NamesTheFileAtFault) {
  EXPECT_THAT(refusal({"render", "missing.atlas", "-o", "x.png"}, 1), HasSubstr("missing.atlas: "));
  EXPECT_THAT(refusal({"render", phantom_folder().file("labels.nrrd"), "-o", "x.png"}, 3),
              HasSubstr("not an atlas"));
  EXPECT_THAT(refusal({"render", phantom_folder().path().string(), "-o", "x.png"}, 3), HasSubstr("a folder"));
  EXPECT_THAT(refusal({"render", phantom_atlas(), "-o", "x.bmp"}, 2),
              HasSubstr(".png, .jpg, .tif, .exr, .svg or .pdf"));
  EXPECT_THAT(refusal({"render", phantom_atlas(), "-o", "nowhere/x.png"}, 1),
              HasSubstr("nowhere/x.png: cannot be written"));
  EXPECT_THAT(refusal({"render", phantom_atlas(), "-o", ""}, 2),
              HasSubstr("--output \"\": must name a file"));
}

TEST(PlayerUsage, NamesTheOptionAtFault) {
  EXPECT_THAT(refused_picture({"--select", "Spere"}, 4), HasSubstr("Sphere 1"));
  EXPECT_THAT(refused_picture({"--select", "#3"}, 4), HasSubstr("the nearest: #2 (\"Sphere 2\"), #1"));
  EXPECT_THAT(refused_picture({"--select", "#x"}), HasSubstr("not a label"));
  const std::vector<std::pair<Words, std::string>> cases{
      {{"--select", "\"Sphere 1\":solid"}, "solid"},
      {{"--select", "\"Sphere 1\"(opacity=2)"}, "opacity"},
      {{"--select", "\"Sphere 1\"(low=9,high=3)"}, "column 23: low 9 must be below high 3"},
      {{"--size", "0x10"}, "--size \"0x10\": must be WIDTHxHEIGHT in pixels, each from 1 to 32768"},
      {{"--size", "100000x100000"}, "--size \"100000x100000\": "},
      {{"--size", "32768x32768", "--background", "transparent"}, "2^32"},
      {{"--size", "10"}, "WIDTHxHEIGHT"},
      {{"--azimuth", "nan"}, "--azimuth \"nan\": must be a finite angle"},
      {{"--elevation", "inf"}, "--elevation \"inf\": must be a finite angle"},
      {{"--max-work", "nan"}, "--max-work \"nan\": must be a number from 0.001 to 1e9"},
      {{"--max-work", "2x"}, "--max-work \"2x\": must be a number from 0.001 to 1e9"},
      {{"--max-work", ""}, "--max-work \"\": must be a number from 0.001 to 1e9"},
      {{"--max-work", "0.0005"}, "--max-work \"0.0005\": must be a number from 0.001 to 1e9"},
      {{"--zoom", "0"}, "--zoom \"0\": must be a number from 1e-6 to 1e6"},
      {{"--view", "top"}, "superior"},
      {{"--quality", "best"}, "draft, normal or high"},
      {{"--background", "blue"}, "--background \"blue\": must be #rrggbb or transparent"},
      {{"--projection", "fisheye"}, "parallel or perspective"},
      {{"--classify", "never"}, "before or after"},
      {{"--cut", "left"}, "--cut \"left\": must be SIDE=MM"},
      {{"--cut", "top=3"}, "--cut \"top=3\": must be SIDE=MM"},
      {{"--cut", "left=3mm"}, "--cut \"left=3mm\": must be SIDE=MM"},
      {{"--cut", "1,0,0"}, "--cut \"1,0,0\": must be SIDE=MM"},
      {{"--cut", "1,0,0,2,3"}, "NX,NY,NZ,D"},
      {{"--cut", "0,0,0,2"}, "--cut \"0,0,0,2\": must have finite numbers and a normal other than 0"},
      {{"--cut", "left=inf"}, "--cut \"left=inf\": must have finite numbers"},
      {{"--cut", "left=1", "--cut", "left=2", "--cut", "left=3", "--cut", "left=4", "--cut", "left=5",
        "--cut", "left=6", "--cut", "left=7"},
       "--cut \"left=7\": is one too many"},
      {{"--cap", "skin"}, "values, labels, both or none"},
      {{"--projection", "perspective", "--field-of-view", "0"},
       "--field-of-view 0 must be from 0.001 to 179 degrees"},
      {{"--projection", "perspective", "--field-of-view", "180"},
       "--field-of-view 180 must be from 0.001 to 179 degrees"},
      {{"--projection", "perspective", "--field-of-view", "nan"},
       "--field-of-view nan must be from 0.001 to 179 degrees"},
      {{"--projection", "perspective", "--field-of-view", "-5"},
       "--field-of-view -5 must be from 0.001 to 179 degrees"},
      {{"--field-of-view", "40"}, "--projection perspective"},
      {{"--projection", "perspective", "--azimuth", "40", "--field-of-view", "150", "--select",
        "\"Sphere 1\":surface"},
       "--field-of-view 150 is too wide for surfaces"}};
  for (const auto& [options, text] : cases) EXPECT_THAT(refused_picture(options), HasSubstr(text));
}

TEST(PlayerUsage, RefusesValuesThatDoNotParse) {
  for (const std::string option : {"--size", "--view", "--azimuth", "--elevation", "--zoom", "--projection",
                                   "--field-of-view", "--classify", "--quality", "--shading", "--cut",
                                   "--cap", "--depth-cue", "--background", "--threads", "--stats"}) {
    EXPECT_THAT(refused_picture({option, ""}), HasSubstr(option));
  }
  for (const std::string size :
       {" 10x10", "10x10 ", "10 x10", "10x", "x10", "10x10x", "+10x10", "0x1px", "99999999999x1"}) {
    EXPECT_THAT(refused_picture({"--size", size}), HasSubstr("WIDTHxHEIGHT"));
  }
  for (const std::string number : {" 1", "1 ", "1,5", "1e", "0x1", "--"})
    EXPECT_THAT(refused_picture({"--zoom=" + number}), HasSubstr("--zoom"));
  for (const std::string threads : {"-1", "1.5", "2000", "two"}) {
    EXPECT_THAT(refused_picture({"--threads=" + threads}), HasSubstr("--threads"));
    EXPECT_THAT(refusal({phantom_atlas(), "--threads=" + threads}, 2), HasSubstr("--threads"));
  }
}

TEST(PlayerUsage, EscapesInvalidText) {
  EXPECT_THAT(refused_picture({"--select", "Sph\xff\xfe"}, 4), HasSubstr("\"Sph\\xff\\xfe\""));
  EXPECT_THAT(refusal({"render", "a\nb\x9b.atlas", "-o", "x.png"}, 1), HasSubstr("a?b\\x9b.atlas: "));
  EXPECT_THAT(refusal({"render", "a.atlas", "-o", "x.png", "--no\n\xff"}, 2), HasSubstr("--no?\\xff"));
}

TEST(PlayerUsage, IsExplainedInOneLine) {
  const std::string atlas = phantom_atlas();
  const std::string no_command = "\"rendr\" is no command (render, info, verify) and no atlas file";
  const std::string unexpected = "The following argument was not expected: ";
  const std::vector<std::pair<Words, std::string>> cases{
      {{}, "no atlas file is given; see splatlas-player --help"},
      {{"render"}, "ATLAS is required; see splatlas-player render --help"},
      {{"render", atlas}, "--output is required; see splatlas-player render --help"},
      {{"info"}, "ATLAS is required; see splatlas-player info --help"},
      {{"--no-such-option"}, unexpected + "--no-such-option; see splatlas-player --help"},
      {{"verify", atlas, atlas}, unexpected + atlas + "; see splatlas-player verify --help"},
      {{"rendr"}, no_command + "; see splatlas-player --help"},
      {{"rendr", atlas}, no_command + "; see splatlas-player --help"},
      {{"rendr", atlas, "-o", "x.png"}, no_command + "; see splatlas-player --help"},
      {{atlas, "more"}, unexpected + "more; see splatlas-player --help"}};
  for (const auto& [words, line] : cases) EXPECT_EQ(refusal(words, 2), "splatlas-player: " + line + "\n");
}

TEST(PlayerUsage, HelpTeaches) {
  const ProgramResult help = run_player({"render", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*"));
  EXPECT_THAT(help.out, HasSubstr("Exit status"));
  EXPECT_THAT(run_player({"verify", "--help"}).out, HasSubstr("stops at the first fault"));
}

}  // namespace
}  // namespace splatlas
