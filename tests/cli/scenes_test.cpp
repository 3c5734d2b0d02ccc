// Scenes of a lesson: built into an atlas, listed, and rendered by name.

#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/hostile_atlas.h"
#include "tests/cli/programs.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

}  // namespace
}  // namespace splatlas
