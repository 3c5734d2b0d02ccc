// Scenes of a lesson: built into an atlas, listed, rendered by name; handouts, turns, standard output.

#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/hostile_atlas.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

struct Scenes : testing::Test {
  TemporaryFolder folder;
  Scenes() {
    std::ofstream(folder.file("labels.nrrd"), std::ios::binary)
        << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 6 4\n"
           "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n"
        << std::string(96, '\1') + std::string(96, '\2');
    write("lesson.toml",
          "[[scene]]\nname = \"Two slabs\"\nselect = \"*:surface\"\ncaption = \"Below and above\"\n"
          "[[scene]]\nname = \"Upper slab\"\nselect = \"#2:surface(color=#ff0000)\"\nazimuth = 35\nelevation "
          "= 20\n"
          "zoom = 0.8\n");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder.file(name), std::ios::binary) << text;
  }
  [[nodiscard]] ProgramResult build(const Words& options) const {
    return run_preprocess(
        joined({"build", "-o", "a.atlas", "--labels", "labels.nrrd", "--progress", "none"}, options),
        folder.path());
  }
  [[nodiscard]] ProgramResult render(const Words& options) const {
    return run_player(joined({"render", "a.atlas", "--size", "900x600"}, options), folder.path());
  }
};

TEST_F(Scenes, AreDrawnAsTheirOptionsWould) {
  const ProgramResult built = build({"--scene", "lesson.toml"});
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_THAT(run_player({"info", "a.atlas"}, folder.path()).out,
              HasSubstr("\nscenes    \"Two slabs\", \"Upper slab\"\n\nstructure"));
  ASSERT_EQ(render({"-o", "a.png", "--scene", "upper SLAB"}).status, 0);
  ASSERT_EQ(render({"-o", "b.png", "--select", "#2:surface(color=#ff0000)", "--azimuth", "35", "--elevation",
                    "20", "--zoom", "0.8"})
                .status,
            0);
  EXPECT_TRUE(read_bytes(folder.file("a.png")) == read_bytes(folder.file("b.png")));
  ASSERT_EQ(render({"-o", "c.svg", "--scene", "Two slabs", "--annotate", "caption"}).status, 0);
  EXPECT_THAT(read_bytes(folder.file("c.svg")), HasSubstr(">Below and above</text>"));
  ASSERT_EQ(
      render({"-o", "d.svg", "--scene", "Two slabs", "--annotate", "caption", "--caption", "Mine"}).status,
      0);
  EXPECT_THAT(read_bytes(folder.file("d.svg")), HasSubstr(">Mine</text>"));
}

TEST_F(Scenes, CutAndCentre) {
  write(
      "cut.toml",
      "[[scene]]\nname = \"Cut\"\nselect = \"*:volume\"\nzoom = 1.5\ncenter = \"#2\"\ncuts = [\"left=0.5\", "
      "\"0,0,1,2\"]\n");
  ASSERT_EQ(build({"--scene", "cut.toml"}).status, 0);
  ASSERT_EQ(render({"-o", "a.png", "--scene", "Cut"}).status, 0);
  ASSERT_EQ(render({"-o", "b.png", "--select", "*:volume", "--zoom", "1.5", "--center", "#2", "--cut",
                    "left=0.5", "--cut", "0,0,1,2"})
                .status,
            0);
  EXPECT_TRUE(read_bytes(folder.file("a.png")) == read_bytes(folder.file("b.png")));
  ASSERT_EQ(render({"-o", "c.png", "--scene", "Cut", "--cut", "left=0.5"}).status, 0);
  EXPECT_FALSE(read_bytes(folder.file("a.png")) == read_bytes(folder.file("c.png")));
}

TEST_F(Scenes, HaveViewProjectionLabelsAndLines) {
  write("keys.toml",
        "[[scene]]\nname = \"A\"\nselect = \"*:surface\"\nview = \"superior\"\nprojection = \"perspective\"\n"
        "labels = [\"Label 2\"]\ncaption = \"\"\"\nFirst.\nSecond.\"\"\"\n"
        "[[scene]]\nname = \"B\"\nselect = \"*:surface\"\nview = \"left\"\nlabels = [\"Label 2\"]\n");
  ASSERT_EQ(build({"--scene", "keys.toml"}).status, 0);
  const auto same = [&](const Words& a, const Words& b) {
    EXPECT_EQ(render(joined(a, {"-o", "a.png"})).status, 0);
    EXPECT_EQ(render(joined(b, {"-o", "b.png", "--select", "*:surface"})).status, 0);
    return read_bytes(folder.file("a.png")) == read_bytes(folder.file("b.png"));
  };
  EXPECT_TRUE(same({"--scene", "A"}, {"--view", "superior", "--projection", "perspective"}));
  EXPECT_TRUE(same({"--scene", "A", "--projection", "parallel"}, {"--view", "superior"}));
  EXPECT_TRUE(same({"--scene", "B"}, {"--view", "left"}));

  ASSERT_EQ(render({"-o", "a.svg", "--scene", "A", "--annotate", "caption"}).status, 0);
  EXPECT_THAT(read_bytes(folder.file("a.svg")),
              AllOf(HasSubstr(">First.</text>"), HasSubstr(">Second.</text>")));
  ASSERT_EQ(render({"-o", "b.svg", "--scene", "B", "--annotate", "labels"}).status, 0);
  EXPECT_THAT(read_bytes(folder.file("b.svg")),
              AllOf(HasSubstr(">Label 2</text>"), Not(HasSubstr("Label 1")), Not(HasSubstr("not labelled"))));

  const auto scene =
      nlohmann::json::parse(run_player({"info", "a.atlas", "--json"}, folder.path()).out)["scenes"][0];
  EXPECT_EQ(scene["azimuth"], 180);
  EXPECT_EQ(scene["elevation"], 90);
  EXPECT_EQ(scene["projection"], "perspective");
  EXPECT_EQ(scene["labels"], nlohmann::json({"Label 2"}));
  EXPECT_EQ(scene["caption"], "First.\nSecond.");
}

TEST_F(Scenes, TellWhatIsWrong) {
  write("nowhere.toml", "[[scene]]\nname = \"A\"\nselect = \"*\"\ncenter = \"Liver\"\n");
  write("unlabelled.toml", "[[scene]]\nname = \"A\"\nselect = \"*\"\nlabels = [\"Liver\"]\n");
  write("same.toml", "[[scene]]\nname = \"two slabs\"\nselect = \"*\"\n");
  for (const auto& [options, message] :
       {std::pair<Words, std::string>{{"--scene", "nowhere.toml"}, "nowhere.toml: scene \"A\": "},
        {{"--scene", "unlabelled.toml"},
         "unlabelled.toml: scene \"A\": no structure is called \"Liver\"; the nearest: \"Label 1\", \"Label "
         "2\""},
        {{"--scene", "lesson.toml", "--scene", "same.toml"},
         "same.toml: scene \"two slabs\": another file has one of this name; rename one"}}) {
    const ProgramResult result = build(options);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_EQ(
      run_preprocess({"build", "-o", "lesson.toml", "--labels", "labels.nrrd", "--scene", "lesson.toml"},
                     folder.path())
          .status,
      2);
  ASSERT_EQ(build({"--scene", "lesson.toml"}).status, 0);
  const ProgramResult unknown = render({"-o", "x.png", "--scene", "Liver"});
  EXPECT_EQ(unknown.status, 4);
  EXPECT_THAT(unknown.err,
              AllOf(HasSubstr("--scene \"Liver\": the atlas has the scenes \"Two slabs\", \"Upper slab\"")));
  for (const Words& other : {Words{"--select", "*"}, {"--view", "left"}, {"--azimuth", "3"}}) {
    const ProgramResult both = render(joined({"-o", "x.png", "--scene", "Two slabs"}, other));
    EXPECT_EQ(both.status, 2);
    EXPECT_THAT(both.err, HasSubstr("--scene"));
  }
  ASSERT_EQ(build({}).status, 0);
  EXPECT_THAT(render({"-o", "x.png", "--scene", "A"}).err,
              HasSubstr("no scenes; build it with --scene FILE.toml"));
}

TEST_F(Scenes, AreReplacedWithoutSources) {
  write("other.toml", "[[scene]]\nname = \"Other\"\nselect = \"#2\"\n");
  const auto lesson = [&](const Words& options) {
    return run_preprocess(joined({"lesson", "a.atlas"}, options), folder.path());
  };
  ASSERT_EQ(build({"--scene", "lesson.toml"}).status, 0);
  const std::string built = read_bytes(folder.file("a.atlas"));
  const ProgramResult result = lesson({"--scene", "other.toml", "--scene", "lesson.toml", "-o", "b.atlas"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "b.atlas: 3 scenes\n");
  EXPECT_THAT(run_player({"info", "b.atlas"}, folder.path()).out,
              HasSubstr("\nscenes    \"Other\", \"Two slabs\", \"Upper slab\"\n"));
  EXPECT_EQ(run_player({"verify", "b.atlas"}, folder.path()).status, 0);
  EXPECT_EQ(lesson({"--scene", "lesson.toml", "-o", "b.atlas"}).status, 0);
  EXPECT_TRUE(read_bytes(folder.file("b.atlas")) == built) << "as build writes these scenes";

  write("stale.toml", "[[scene]]\nname = \"A\"\nselect = '\"Label 9\"'\n");
  std::string damaged = built;
  damaged[100] ^= 1;
  write("damaged.atlas", damaged);
  const std::string out = "-o";
  for (const auto& [words, status, message] :
       {std::tuple<Words, int, std::string>{
            {"a.atlas", "--scene", "other.toml", out, "a.atlas"}, 2, "is an input"},
        {{"a.atlas", "--scene", "stale.toml", out, "b.atlas"},
         1,
         "stale.toml: scene \"A\": selection, column 1: no structure is called \"Label 9\"; the nearest: "
         "\"Label 1\", \"Label 2\""},
        {{"damaged.atlas", "--scene", "other.toml", out, "b.atlas"},
         3,
         "damaged.atlas: damaged: checksum of the directory"}}) {
    const ProgramResult refused = run_preprocess(joined({"lesson"}, words), folder.path());
    EXPECT_EQ(refused.status, status);
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  EXPECT_TRUE(read_bytes(folder.file("a.atlas")) == built);
  EXPECT_TRUE(read_bytes(folder.file("b.atlas")) == built);
}

/// Also of a scene that the user names: the file is at fault.
TEST_F(Scenes, FaultyOnesAreFaultsOfTheAtlas) {
  AtlasContent content = hostile_content({"a"}, {"a"});
  content.scenes = {{"syntax", "", "a +"}, {"name", "", "nobody"}};
  content.scenes.push_back({.name = "cut", .caption = "", .selection = "*", .cuts = "left"});
  content.scenes.push_back({.name = "center", .caption = "", .selection = "*", .center = "nobody"});
  content.scenes.push_back({.name = "label", .caption = "", .selection = "*", .labels = {"nobody"}});
  write_bytes(folder.file("bad.atlas"), value_or_throw(encode_atlas(content)));
  for (const std::string name : {"syntax", "name", "cut", "center", "label"}) {
    const ProgramResult result =
        run_player({"render", "bad.atlas", "-o", "x.png", "--scene", name}, folder.path());
    EXPECT_EQ(result.status, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr("bad.atlas: scene \"" + name + "\": "));
  }
}

struct Sequences : testing::Test {
  TemporaryFolder folder;
  Sequences() {
    std::ofstream(folder.file("labels.nrrd"), std::ios::binary)
        << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 12 4 4\n"
           "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n"
        << std::string(96, '\1') + std::string(96, '\2');
    std::ofstream(folder.file("lesson.toml"))
        << "[[scene]]\nname = \"<b>A&B\"\nselect = \"*:surface\"\nquestion = \"Which \\\"one\\\"?\"\n"
           "caption = \"First.\\n</p><script>Second.\"\n"
           "[[scene]]\nname = \"Upper\"\nselect = \"#2:surface\"\nazimuth = 35\n";
    const ProgramResult built = run_preprocess(
        {"build", "-o", "a.atlas", "--labels", "labels.nrrd", "--scene", "lesson.toml", "--progress", "none"},
        folder.path());
    EXPECT_EQ(built.status, 0) << built.err;
  }
  [[nodiscard]] ProgramResult render(const Words& options) const {
    return run_player(joined({"render", "a.atlas", "--size", "300x200"}, options), folder.path());
  }
  [[nodiscard]] auto bytes(const std::string& name) const { return read_bytes(folder.file(name)); }
};

TEST_F(Sequences, StandardOutputIsTheFile) {
  const Words options{"--scene", "Upper", "--annotate", "scalebar"};
  ASSERT_EQ(render(joined(options, {"-o", "a.png"})).status, 0);
  EXPECT_TRUE(render(joined(options, {"-o", "-"})).out == bytes("a.png"));
  const ProgramResult failed = render({"-o", "-", "--select", "Liver"});
  EXPECT_EQ(failed.status, 4);
  EXPECT_EQ(failed.out, "");
  const Words words{SPLATLAS_PLAYER, "render", "a.atlas", "-o", "-"};
  EXPECT_EQ(run_by_shell(kFullDevice, words, folder.path()).status, 1);
  const ProgramResult terminal = run_by_shell(R"(exec script -qec "$0 $*" /dev/null)", words, folder.path());
  EXPECT_THAT(terminal.out, HasSubstr("standard output is a terminal; redirect it"));
}

TEST_F(Sequences, HandoutHasAllScenes) {
  ASSERT_EQ(render({"--scenes", "h"}).status, 0);
  EXPECT_EQ(run_program({"ls", "h"}, folder.path()).out, "01.png\n02.png\nhandout.html\nhandout.pdf\n");
  ASSERT_EQ(render({"-o", "2.png", "--scene", "Upper", "--background", "#ffffff"}).status, 0);
  EXPECT_TRUE(bytes("h/02.png") == bytes("2.png"));
  EXPECT_THAT(
      bytes("h/handout.html"),
      AllOf(HasSubstr("<h2 dir=\"auto\">1. &lt;b&gt;A&amp;B</h2>\n<img src=\"01.png\" "
                      "alt=\"1. &lt;b&gt;A&amp;B\">\n<em dir=\"auto\">Which &quot;one&quot;?</em>\n"
                      "<p dir=\"auto\">First.\n&lt;/p&gt;&lt;script&gt;Second.</p>\n</section>"),
            HasSubstr("default-src 'none'"), HasSubstr("<img src=\"02.png\""), Not(HasSubstr("<script"))));
  EXPECT_THAT(run_program({"pdfinfo", "h/handout.pdf"}, folder.path()).out,
              AllOf(HasSubstr("Pages:           2\n"), HasSubstr("(A4)")));
  EXPECT_EQ(run_program({"pdftotext", "h/handout.pdf", "-"}, folder.path()).out,
            "1. <b>A&B\n\nWhich \"one\"?\nFirst.\n</p><script>Second.\n\n\f2. Upper\n\n\f");
}

TEST_F(Sequences, TurnHasOneCamera) {
  const Words grid{"--fit", "grid", "--zoom", "1.2"};
  ASSERT_EQ(render(joined(grid, {"-o", "t", "--azimuth", "20", "--turn", "180", "--frames", "2"})).status, 0);
  ASSERT_EQ(render(joined(grid, {"-o", "a.png", "--azimuth", "20"})).status, 0);
  ASSERT_EQ(render(joined(grid, {"-o", "b.png", "--azimuth", "110"})).status, 0);
  EXPECT_TRUE(bytes("t/0001.png") == bytes("a.png"));
  EXPECT_TRUE(bytes("t/0002.png") == bytes("b.png"));

  // The fit holds for all frames: the first one sees the wedge from its short end
  const Words wedge{"--cut", "1,0,1,4", "--elevation", "40", "--azimuth", "90", "--select", "*:surface"};
  ASSERT_EQ(render(joined(wedge, {"-o", "u", "--turn", "360", "--frames", "8"})).status, 0);
  for (int n = 1; n <= 8; ++n) {
    const auto pixels = read_pixels(folder.file("u/000" + std::to_string(n) + ".png"));
    ASSERT_EQ(pixels.size(), 300u * 200 * 3);
    float border = 0;
    for (std::size_t at = 0; at < pixels.size(); ++at)
      border += at / 3 % 300 % 299 == 0 || at / 900 % 199 == 0 ? pixels[at] : 0;
    EXPECT_EQ(border, 0) << n;
  }
}

TEST_F(Sequences, FailuresLeaveNothing) {
  ASSERT_EQ(run_preprocess({"build", "-o", "b.atlas", "--labels", "labels.nrrd"}, folder.path()).status, 0);
  const auto before = folder.names();
  for (const auto& [options, status, message] :
       {std::tuple<Words, int, std::string>{
            {"b.atlas", "--scenes", "x"}, 1, "no scenes; add some with splatlas-preprocess lesson"},
        {{"a.atlas", "--scenes", "x", "--view", "left"}, 2, "--view excludes --scenes"},
        {{"a.atlas", "--scenes", "x", "--center", "Liver"}, 4, "--center"},
        {{"a.atlas", "-o", "x.png", "--turn", "90", "--frames", "3"}, 2, "x.png: must name a folder"}}) {
    const ProgramResult failed = run_player(joined({"render"}, options), folder.path());
    EXPECT_EQ(failed.status, status) << failed.err;
    EXPECT_THAT(failed.err, HasSubstr(message));
    EXPECT_EQ(folder.names(), before);
  }
}

}  // namespace
}  // namespace splatlas
