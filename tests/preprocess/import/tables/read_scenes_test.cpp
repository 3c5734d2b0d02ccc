#include "preprocess/import/tables/read_scenes.h"

#include <fstream>

#include <gmock/gmock.h>

#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

struct ReadScenes : testing::Test {
  TemporaryFolder folder;
  [[nodiscard]] Result<SceneFile> read(const std::string& text) const {
    const std::filesystem::path path = folder.path() / "lesson.toml";
    std::ofstream(path, std::ios::binary) << text;
    return read_scenes(path);
  }
};

TEST_F(ReadScenes, InTheOrderOfTheFile) {
  const auto file = value_or_throw(read(R"(# A lesson
[[scene]]
name = "Whole"
select = "*"

[[scene]]
name = "Größe"
select = '"Sphere 1":surface(opacity=0.5) + Sphere*'
caption = "What is this?"
azimuth = 90
elevation = -12.5
zoom = 2
question = "Which sphere is this?"
center = "1,-2.5,3"
cuts = ["left=10", "0,0,1,2.5"]

[[scene]]
name = "From above"
select = "*"
view = "superior"
projection = "perspective"
labels = ["Sphere 1", "Sph*"]
caption = """
First line.
Second line.
"""

[[scene]]
name = "Elevation alone"
select = "*"
elevation = 90
)"));
  const std::vector<Scene> expected{
      {"Whole", "", "*", 0, 0, 1},
      {"Größe", "What is this?", "\"Sphere 1\":surface(opacity=0.5) + Sphere*", 90, -12.5, 2,
       "Which sphere is this?", "left=10 0,0,1,2.5", "1,-2.5,3"},
      {"From above", "First line.\nSecond line.", "*", 180, 90, 1, "", "", "", true, {"Sphere 1", "Sph*"}},
      {"Elevation alone", "", "*", 180, 90, 1}};
  EXPECT_EQ(file.scenes, expected);
}

TEST_F(ReadScenes, TellsLineAndRemedyOfFaults) {
  const std::string start = "[[scene]]\nname = \"A\"\nselect = \"*\"\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "has no [[scene]]"},
      {"title = \"x\"", "line 1: \"title\" is no [[scene]]"},
      {"scene = 3", "line 1: \"scene\" is no [[scene]]"},
      {"[[scene]]\nname = \"A\n", "line 2: "},
      {"[[scene]]\nname = \"A\"\nselect = 3\n", "line 3: select must be a text in quotes"},
      {"[[scene]]\nselect = \"*\"\n", "line 1: the scene has no name"},
      {"[[scene]]\nname = \"A\"\n", "line 1: scene \"A\" has no selection; add select"},
      {start + "zoom = 0\n", "line 4: zoom 0 must be a number from 0.001 to 1000"},
      {start + "elevation = 91\n", "line 4: elevation 91 must be a number from -90 to 90"},
      {start + "azimuth = nan\n", "line 4: azimuth nan must be a number from -360 to 360"},
      {start + "azimuth = \"left\"\n", "line 4: azimuth \"left\" must be a number"},
      {start + "title = \"x\"\n", "line 4: unknown key \"title\"; a scene has name, select, question"},
      {start + "view = \"above\"\n",
       "line 4: view \"above\" must be anterior, posterior, left, right, superior or"},
      {start + "view = \"left\"\nelevation = 0\n",
       "line 4: a scene with a view has no azimuth and no elevation"},
      {start + "projection = \"flat\"\n", "line 4: projection \"flat\" must be parallel or perspective"},
      {start + "labels = \"A\"\n", "line 4: labels must be a list of texts, as in labels = "},
      {start + "labels = [1]\n", "line 4: each of the labels must be a text in quotes"},
      {start + "cuts = \"left=1\"\n", "line 4: cuts must be a list of texts"},
      {start + "cuts = [\"above=1\"]\n", "line 4: cut \"above=1\" must be SIDE=MM"},
      {start + "cuts = [3]\n", "line 4: each of the cuts must be a text in quotes"},
      {start + "cuts = [\"0,0,0,1\"]\n", "line 4: cut: the plane 0,0,0,1 must have"},
      {start +
           "cuts = [\"left=1\", \"left=1\", \"left=1\", \"left=1\", \"left=1\", \"left=1\", \"left=1\"]\n",
       "line 4: cut: more than 6 planes"},
      {start + "center = \"1,2\"\n", "line 4: center \"1,2\" must be \"X,Y,Z\""},
      {start + "caption = \"a\\u202eb\"\n", "line 4: caption must be lines of visible UTF-8 characters"},
      {start + "question = \"\"\"a\nb\"\"\"\n", "line 4: question must be one line"},
      {start + "caption = \"" + std::string(4001, 'a') + "\"\n",
       "line 4: caption has 4001 bytes; 4000 are allowed"},
      {"[[scene]]\nname = \"A \"\nselect = \"*\"\n", "line 1: name \"A \" begins or ends with a blank"},
      {start + start, "line 4: two scenes have the name \"A\""}};
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(read(text),
                FailsWith(ErrorCode::kFailed, AllOf(HasSubstr("lesson.toml: "), HasSubstr(message))))
        << text;
  }
  EXPECT_THAT(read_scenes(folder.path() / "none.toml"),
              FailsWith(ErrorCode::kFailed, HasSubstr("none.toml")));
}

}  // namespace
}  // namespace splatlas
