// Failing command lines of both programs: one safe line with the fault's file or option, and the exit status.

#include <algorithm>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "format/text/ascii_text.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// A command line that fails.
struct Case {
  Words words;
  int status;
  std::string subject;    ///< start of the message after the program's name: the file or option at fault
  std::string rest = {};  ///< part of the message: fault, value or remedy
};

/// A folder of sound and faulty files.
struct ErrorLines : testing::Test {
  TemporaryFolder folder;

  ErrorLines() {
    for (const std::string name : {"labels.nrrd", "volume.nrrd"})
      fs::copy_file(phantom_folder().file(name), folder.file(name));
    for (const std::string name : {"a.atlas", "a.nii"}) fs::copy_file(phantom_atlas(), folder.file(name));
    write_bytes(folder.file("bad.atlas"), "x");
    write_bytes(folder.file("cut.atlas"), read_bytes(phantom_atlas()).substr(0, 3000));
    write_bytes(folder.file("bad.nrrd"), "NRRD0004\n");
    write_bytes(folder.file("bad.stl"), "solid\n");
    std::string damaged = read_bytes(phantom_atlas());
    damaged[64] ^= 1;  // the directory's first byte
    write_bytes(folder.file("damaged.atlas"), damaged);
    write_bytes(folder.file("bad.txt"), "1 \xff\n");
    write_bytes(folder.file("tab.txt"), "1 a?\tb\n");
    write_bytes(folder.file("bad.tree"), "A/*/x\n");
    write_bytes(folder.file("none.tree"), "A/Nothing\n");
    fs::create_directory(folder.file("full"));
    write_bytes(folder.file("full/file"), "kept");
  }

  /// The text behind the lines that begin with "note:" or "warning:".
  static std::string without_notes(std::string text) {
    while (text.starts_with("note: ") || text.starts_with("warning: ")) text.erase(0, text.find('\n') + 1);
    return text;
  }

  using Run = std::function<ProgramResult(const Words&)>;
  void check(const std::string& program, const std::vector<Case>& cases, const Run& run) const {
    for (const Case& c : cases) {
      std::string line;
      for (const std::string& word : c.words) line += " " + printable(word);
      SCOPED_TRACE(program + line);
      const std::vector<std::string> before = folder.names();
      const ProgramResult result = run(c.words);
      EXPECT_EQ(result.status, c.status);
      const std::string error = without_notes(result.err);
      EXPECT_THAT(error, StartsWith(program + ": " + c.subject));
      EXPECT_THAT(error, HasSubstr(c.rest));
      EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << result.err;
      EXPECT_TRUE(result.err.ends_with('\n'));
      EXPECT_EQ(result.err, printable_lines(result.err));
      EXPECT_EQ(result.out, "");
      EXPECT_EQ(folder.names(), before);
    }
  }
  void check_player(const std::vector<Case>& cases) const {
    check("splatlas-player", cases, [&](const Words& words) { return run_player(words, folder.path()); });
  }
  void check_preprocess(const std::vector<Case>& cases) const {
    check("splatlas-preprocess", cases, [&](const Words& words) {
      const bool builds = words.size() > 1 && words[0] == "build";
      return run_preprocess(builds ? joined(words, {"--progress", "none"}) : words, folder.path());
    });
  }
};

TEST_F(ErrorLines, OfThePlayersCommands) {
  check_player({{{}, 2, "no atlas file is given", "--help"},
                {{"rendr"}, 2, "\"rendr\"", "render, export, info, verify"},
                {{"--none"}, 2, "", "--none; see splatlas-player --help"},
                {{""}, 2, "ATLAS: \"\"", "must name a file"},
                {{"missing.atlas"}, 1, "missing.atlas: ", "No such file"},
                {{"bad.atlas"}, 3, "bad.atlas: ", "not an atlas"},
                {{"info"}, 2, "ATLAS is required", "splatlas-player info --help"},
                {{"info", ""}, 2, "ATLAS: \"\"", "must name a file"},
                {{"info", "missing.atlas"}, 1, "missing.atlas: ", "No such file"},
                {{"info", "missing\x1b[2J\n.atlas"}, 1, "missing?[2J?.atlas: "},
                {{"info", "full"}, 3, "full: ", "a folder"},
                {{"info", "bad.atlas", "--json"}, 3, "bad.atlas: ", "78"},
                {{"info", "a.atlas", "more"}, 2, "", "more; see splatlas-player info --help"},
                {{"info", "a.atlas", "--max-work", "2"},
                 2,
                 "The following arguments were not expected: --max-work 2; see splatlas-player info --help"},
                {{"a.atlas", "b", "c", "--none"},
                 2,
                 "The following arguments were not expected: b c --none; see splatlas-player --help"},
                {{"info", "damaged.atlas"},
                 3,
                 "damaged.atlas: damaged: checksum of the directory is ",
                 "; copy or build the file again"},
                {{"info", "/proc/version"}, 3, "/proc/version: not an atlas (its size is 0 bytes)"},
                {{"verify", "labels.nrrd"}, 3, "labels.nrrd: ", "not an atlas"},
                {{"verify", "cut.atlas"}, 3, "cut.atlas: ", "truncated"},
                {{"verify", "a.atlas", "--json"}, 2, "", "--json; see splatlas-player verify --help"}});
}

TEST_F(ErrorLines, OfRender) {
  std::vector<Case> cases{
      {{"render"}, 2, "ATLAS is required"},
      {{"render", "a.atlas"}, 2, "--output or --scenes is required"},
      {{"render", "", "-o", "x.png"}, 2, "ATLAS: \"\"", "must name a file"},
      {{"render", "missing.atlas", "-o", "x.png"}, 1, "missing.atlas: "},
      {{"render", "cut.atlas", "-o", "x.png"}, 3, "cut.atlas: ", "3000"},
      {{"render", "a.atlas", "-o", ""}, 2, "--output \"\"", "must name a file"},
      {{"render", "a.atlas", "-o", "x.bmp"}, 2, "x.bmp: ", ".png, .jpg, .tif, .exr, .svg or .pdf"},
      {{"render", "missing.atlas", "-o", "full/file/x.png"}, 1, "full/file/x.png: cannot be written: "},
      {{"render", "missing.atlas", "-o", "x.png", "--stats", "./x.png"},
       2,
       "./x.png: ",
       "write to two files"},
      {{"render", "a.atlas", "-o", "x.png", "--stats", "a.atlas"}, 2, "a.atlas: is an input (a.atlas)"},
      {{"render", "a.atlas", "-o", "x.png", "--ids", "./x.png"}, 2, "./x.png: is another output"},
      {{"render", "a.atlas", "-o", "x.exr", "--depth", "./x.exr"}, 2, "./x.exr: is another output"},
      {{"render", "a.atlas", "-o", "x\xe2\x80\x8f.bmp"}, 2, "x?.bmp: "},
      {{"bogus", "render", "a.atlas", "-o", "x.png"}, 2, "\"bogus\" in front of render"},
      {{"--threads", "2", "info", "a.atlas"}, 2, "\"--threads\" in front of info"}};
  const auto refuses = [&](const Words& options, const std::string& subject, const std::string& rest,
                           int status = 2) {
    cases.push_back({joined({"render", "a.atlas", "-o", "x.png"}, options), status, subject, rest});
  };
  refuses({"--size", "0x0"}, "--size \"0x0\"", "from 1 to 32768");
  refuses({"--size", "99999x9"}, "--size \"99999x9\"", "WIDTHxHEIGHT");
  refuses({"--size", "32768x32768", "--background", "transparent"}, "x.png: ", "2^32");
  refuses({"--zoom", "0"}, "--zoom \"0\"", "from 1e-6 to 1e6");
  refuses({"--azimuth", "nan"}, "--azimuth \"nan\"", "finite");
  refuses({"--elevation", "x"}, "--elevation \"x\"", "degrees");
  refuses({"--field-of-view", "20"}, "--field-of-view: ", "--projection perspective");
  refuses({"--projection", "perspective", "--field-of-view", "190"}, "--field-of-view 190", "179");
  refuses({"--view", "up"}, "--view \"up\"", "superior");
  refuses({"--quality", "\x1b"}, "--quality \"?\"", "draft, normal or high");
  refuses({"--surfaces", "round"}, "--surfaces \"round\"", "must be smooth or voxels");
  refuses({"--background", "#000000,blue"}, "--background \"#000000,blue\"", "#rrggbb,#rrggbb");
  cases.push_back({{"render", "a.atlas", "-o", "x.jpeg", "--background", "transparent"},
                   2,
                   "--background \"transparent\": a .jpg picture",
                   ".png"});
  refuses({"--threads", "9999"}, "--threads: ", "9999");
  refuses({"--select", "Nope"}, "a.atlas: selection, column 1", "the nearest: ", 4);
  refuses({"--select", "Sphere*:solid"}, "selection \"Sphere*:solid\"", "column");
  refuses({"--select", "#3"}, "a.atlas: selection", "no structure has the label 3", 4);
  refuses({"--select", "#x"}, "selection \"#x\"", "not a label");
  refuses({"--select", "Sph\xff\xfe"}, "a.atlas: ", "\"Sph\\xff\\xfe\"", 4);
  refuses({"--memory", "15"}, "--memory \"15\"", "must be a number of MiB from 16 to 1073741824");
  refuses({"--max-work", "nan"}, "--max-work \"nan\"", "must be a number from 0.001 to 1e9");
  refuses({"--classify", "never"}, "--classify \"never\"", "before or after");
  refuses({"--projection", "fisheye"}, "--projection \"fisheye\"", "parallel or perspective");
  refuses({"--cap", "skin"}, "--cap \"skin\"", "values, labels, both or none");
  refuses({"--cut", "top=3"}, "--cut \"top=3\"", "must be SIDE=MM");
  refuses({"--cut", "0,0,0,2"}, "--cut \"0,0,0,2\"", "a normal other than 0");
  refuses({"--cut", "left=1", "--cut", "left=2", "--cut", "left=3", "--cut", "left=4", "--cut", "left=5",
           "--cut", "left=6", "--cut", "left=7"},
          "--cut \"left=7\"", "is one too many");
  refuses({"--projection", "perspective", "--azimuth", "40", "--field-of-view", "150", "--select",
           "\"Sphere 1\":surface"},
          "--field-of-view 150", "too wide for surfaces");
  for (const std::string option : {"--size", "--shading", "--depth-cue", "--stats"})
    refuses({option, ""}, option, "");
  refuses({"--ids", "i.jpg"}, "i.jpg: unknown ending '.jpg' of an id image; use .png or .exr", "");
  refuses({"--depth", "d.png"}, "d.png: unknown ending '.png' of a depth map; use .exr", "");
  for (const std::string text : {"1,2", "1,2,3,4", "1, 2,3", "nan,0,0", "0,inf,0", "0,0,1e16", ","})
    refuses({"--center=" + text}, "--center \"" + text + "\": must be X,Y,Z", "");
  refuses({"--center", ""}, "--center \"\": must be X,Y,Z", "");
  refuses({"--center", "Spere 1"}, "a.atlas: --center: no structure is called \"Spere 1\"", "Sphere 1", 4);
  refuses({"--fit", "all"}, "--fit \"all\"", "selection or grid");
  refuses({"--select", "#2:surface", "--zoom", "1e6"}, "--zoom 1000000: multiplied by ", "");
  refuses(
      {"--annotate", "labels,arrows"}, "--annotate",
      "\"arrows\" is no annotation; use labels, legend, scalebar, orientation, caption, citation, or all");
  refuses({"--annotate", ""}, "--annotate", "\"\" is no annotation");
  refuses({"--caption", "x"}, "--caption", "--annotate");
  for (const std::string text : {"a\xff", "a\nb"})
    refuses({"--annotate", "caption", "--caption", text}, "--caption",
            "one line of visible UTF-8 characters");
  refuses({"--annotate", "labels", "--max-labels", "-1"}, "--max-labels", "");
  refuses({"--annotate", "labels", "--dpi", "9"}, "--dpi \"9\": must be a number from 72 to 2400", "");
  refuses({"--annotate", "all", "--size", "50x40"}, "picture size 50x40: too small for its annotations", "");
  refuses({"--annotate", "caption", "--font", "none.ttf"}, "none.ttf: No such file or directory; give a .ttf",
          "", 1);
  refuses({"--annotate", "caption", "--font", "bad.stl"}, "bad.stl: cannot be read as a font with letters",
          "", 1);
  refuses({"--stats", "none/s.json"}, "none/s.json: ", "no folder none", 1);
  refuses({"--none"}, "", "--none; see splatlas-player render --help");
  check_player(cases);
}

TEST_F(ErrorLines, OfPreprocessCommandsAndExport) {
  check_preprocess(
      {{{}, 2, "no command is given", "splatlas-preprocess --help"},
       {{"bild"}, 2, "\"bild\": no such command", "build, check, export and lesson"},
       {{"--none"}, 2, "\"--none\": no such option", "splatlas-preprocess --help"},
       {{"export"}, 2, "ATLAS is required", "splatlas-preprocess export --help"},
       {{"export", "", "--labels", "x.nii"}, 2, "ATLAS: \"\"", "must name a file"},
       {{"export", "a.atlas"},
        2,
        "a.atlas: nothing to export",
        "--labels, --volume, --surface, --names or --tree"},
       {{"export", "a.atlas", "--labels", ""}, 2, "--labels: \"\"", "must name a file"},
       {{"export", "a.atlas", "--volume", ""}, 2, "--volume: \"\"", "must name a file"},
       {{"export", "missing.atlas", "--labels", "x.nii"}, 1, "missing.atlas: "},
       {{"export", "bad.atlas", "--labels", "x.nii"}, 3, "bad.atlas: "},
       {{"export", "cut.atlas", "--labels", "x.nii"}, 3, "cut.atlas: "},
       {{"export", "bad.atlas", "--labels", "x.foo"}, 2, "x.foo: ", ".nii.gz"},
       {{"export", "a.atlas", "--labels", "full/"}, 1, "full/: ", "not an empty folder"},
       {{"export", "a.atlas", "--labels", "l.nii", "--volume", "none/x.nii"}, 1, "none/x.nii: ", "no folder"},
       {{"export", "a.nii", "--labels", "a.nii"}, 2, "a.nii: is an input (a.nii)"},
       {{"export", "a.atlas", "--surface", "#1=s.stl", "--surface", "#2=s.stl"},
        2,
        "s.stl: is another output"},
       {{"export", "a.atlas", "--labels", "m/", "--surface", "#1=m/s.stl"},
        2,
        "m/s.stl: ",
        "folder of masks"},
       {{"export", "a.atlas", "--volume", "x.mhd"}, 2, "x.mhd: ", "write .mha"},
       {{"export", "a.atlas", "--surfaces", "round"}, 2, "--surfaces \"round\"", "must be smooth or voxels"},
       {{"export", "a.atlas", "--surface", "x"}, 2, "--surface 'x'", "NAME=FILE"},
       {{"export", "a.atlas", "--surface", "Nope=x.stl"}, 4, "a.atlas: ", "the nearest: "},
       {{"export", "a.atlas", "--surface", "Sphere 1=x.foo"}, 2, "x.foo: ", ".stl"},
       {{"export", "a.atlas", "--labels", "x.nii", "--volume", "x.nii"}, 2, "x.nii: "},
       {{"export", "a.atlas", "b", "--none"}, 2, "The following arguments were not expected: b --none; see"},
       {{"export", "a.atlas", "--none"}, 2, "", "--none; see splatlas-preprocess export --help"}});
}

TEST_F(ErrorLines, OfBuild) {
  std::vector<Case> cases{
      {{"build"}, 2, "--output is required", "splatlas-preprocess build --help"},
      {{"build", "-o", "x.atlas"}, 2, "no structures: give --labels, a --segment or a --mesh"},
      {{"build", "-o", "", "--labels", "labels.nrrd"}, 2, "--output: \"\"", "must name a file"},
      {{"build", "-o", "x.atlas", "--labels", ""}, 2, "--labels: \"\"", "must name a file"},
      {{"build", "-o", "x.atlas", "--labels", "missing.nrrd"}, 1, "missing.nrrd: ", "no such file"},
      {{"build", "-o", "x.atlas", "--labels", "m\n.nrrd"}, 1, "m?.nrrd: ", "no such file"},
      {{"build", "-o", "x.atlas", "--labels", "full"}, 1, "full: ", "no mask"},
      {{"build", "-o", "x.atlas", "--labels", "bad.nrrd"}, 1, "bad.nrrd: ", "zero element size"},
      {{"build", "-o", "x.atlas", "--labels", "bad.txt"}, 1, "bad.txt: ", ".nii.gz"},
      {{"build", "-o", "x.atlas", "--names", "tab.txt"}, 2, "no structures: give --labels"},
      {{"build", "-o", "x.atlas", "--volume", "volume.nrrd", "--segment", "S=threshold:1e9"},
       1,
       "--segment \"S\"",
       "thresholds"}};
  const auto refuses = [&](const Words& options, const std::string& subject, const std::string& rest,
                           int status = 1) {
    cases.push_back(
        {joined({"build", "-o", "x.atlas", "--labels", "labels.nrrd"}, options), status, subject, rest});
  };
  refuses({"--volume", "bad.nrrd"}, "bad.nrrd: ", "zero element size");
  refuses({"--volume", ""}, "--volume: \"\"", "must name a file", 2);
  refuses({"--names", "missing.txt"}, "missing.txt: ", "no such file");
  refuses({"--names", "bad.txt"}, "bad.txt: line 1", "UTF-8");
  refuses({"--names", "tab.txt"}, "tab.txt: cannot be read as list of labels and names: line 1",
          "\"a??b\" holds a tab as character 3");
  refuses({"--tree", "bad.tree"}, "bad.tree: line 1", "pattern");
  refuses({"--tree", "none.tree"}, "none.tree: line 1", "the nearest: ");
  refuses({"--mesh", "S"}, "--mesh \"S\"", "NAME=FILE", 2);
  refuses({"--mesh", "S=missing.stl"}, "missing.stl: ", "no such file");
  refuses({"--mesh", "S=bad.stl"}, "bad.stl: ", "STL");
  refuses({"--segment", "S"}, "--segment 'S'", "threshold:otsu", 2);
  refuses({"--segment", "S=threshold:9:1"}, "--segment 'S=threshold:9:1'", "LOW at most HIGH", 2);
  refuses({"--segment", "S=threshold:1:close=99"}, "--segment 'S=threshold:1:close=99'", "MM from 0 to 50",
          2);
  refuses({"--segment", "S=threshold:1"}, "--segment \"S\"", "--volume", 2);
  refuses({"--segment", "S=mask:missing.nrrd"}, "missing.nrrd: ", "no such file");
  refuses({"--level", "99"}, "--level: ", "1 to 22", 2);
  refuses({"--mesh", "A=a.stl,frame=x"}, "--mesh", "frame=x must be ras or lps", 2);
  refuses({"--mesh", "A=a.stl,size=3"}, "--mesh", "size=3 is no option", 2);
  refuses({"--mesh", "A=a.stl,scale=0"}, "--mesh", "scale=0 must be a number above 0", 2);
  refuses({"--json", "labels.nrrd"}, "labels.nrrd", "is an input", 2);
  refuses({"--mesh", "A=a.stl,transform=tab.txt", "--report", "tab.txt"}, "tab.txt: is an input", "", 2);
  refuses({"--report", "x.atlas"}, "x.atlas", "", 2);
  refuses({"--json", "none/x.json"}, "none/x.json", "no folder");
  refuses({"--title", "\x1b"}, "--title: \"?\"", "control character", 2);
  check_preprocess(cases);
}

TEST(Help, Teaches) {
  const ProgramResult help = run_player({"render", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*"));
  EXPECT_THAT(help.out, HasSubstr("Exit status"));
  EXPECT_THAT(run_player({"verify", "--help"}).out, HasSubstr("stops at the first fault"));
}

/// Without memory, every message still names the file.
TEST_F(ErrorLines, OfExhaustedMemory) {
  const auto run_with = [&](rlim_t megabytes, const Words& words) {
    return run_program(words, folder.path(), {}, [megabytes] {
      const rlimit limit{megabytes << 20, megabytes << 20};
      setrlimit(RLIMIT_AS, &limit);
    });
  };
  const auto check_limit = [&](const std::string& program, const std::string& path, const Words& words,
                               const std::string& file) {
    int failures = 0;
    for (rlim_t megabytes = 256; megabytes >= 16; megabytes -= 8) {
      const ProgramResult result = run_with(megabytes, joined({path}, words));
      if (result.status == 0) continue;
      if (!result.err.starts_with(program)) break;  // the limit is too low to load the program
      ++failures;
      EXPECT_EQ(result.status, 1) << result.err;
      EXPECT_THAT(result.err, StartsWith(program + ": " + file + ": ")) << megabytes << " MiB";
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    EXPECT_GT(failures, 0);
  };
  check_limit("splatlas-player", SPLATLAS_PLAYER,
              {"render", "a.atlas", "-o", "x.png", "--size", "1500x1500", "--threads", "1"}, "a.atlas");
}

}  // namespace
}  // namespace splatlas
