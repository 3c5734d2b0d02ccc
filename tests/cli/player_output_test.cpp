// Output files of splatlas-player: complete or absent, and never over an input.

#include <filesystem>

#include <gmock/gmock.h>

#include "tests/cli/phantom_atlas.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kFont = "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf";

/// A folder with one atlas under several names.
struct PlayerOutput : testing::Test {
  TemporaryFolder folder;
  PlayerOutput() {
    fs::copy_file(phantom_atlas(), folder.file("a.png"));
    fs::create_symlink("a.png", folder.file("link.png"));
    fs::create_hard_link(folder.file("a.png"), folder.file("hard.png"));
  }
  [[nodiscard]] ProgramResult render(const Words& options) const {
    return run_player(joined({"render", "a.png", "--size", "64x64"}, options), folder.path());
  }
  void expect_unchanged() const {
    EXPECT_THAT(folder.names(), ElementsAre("a.png", "hard.png", "link.png"));
    EXPECT_TRUE(read_bytes(folder.file("a.png")) == read_bytes(phantom_atlas()));
  }
};

TEST_F(PlayerOutput, IsNeverAnInput) {
  for (const std::string& same : Words{"a.png", "./a.png", "link.png", "hard.png", folder.file("a.png")}) {
    for (const Words& words : {Words{"-o", same}, {"-o", "x.png", "--stats", same}}) {
      const ProgramResult result = render(words);
      EXPECT_EQ(result.status, 2) << same;
      EXPECT_EQ(result.err, "splatlas-player: " + same + ": is an input (a.png); write to another file\n");
      expect_unchanged();
    }
  }
}

TEST_F(PlayerOutput, IsNeverTheFont) {
  const TemporaryFolder fonts;
  const std::string font = fonts.file("font.png"), before = read_bytes(kFont);
  fs::copy_file(kFont, font);
  fs::create_symlink(font, fonts.file("link.json"));
  const Words annotated{"--annotate", "caption", "--caption", "A", "--font", font};
  for (const Words& words : {Words{"-o", font},
                             {"-o", "x.png", "--stats", fonts.file("link.json")},
                             {"-o", "x.png", "--ids", font}}) {
    const ProgramResult result = render(joined(annotated, words));
    EXPECT_EQ(result.status, 2) << words.back();
    EXPECT_EQ(result.err,
              "splatlas-player: " + words.back() + ": is an input (" + font + "); write to another file\n");
    EXPECT_TRUE(read_bytes(font) == before);
    expect_unchanged();
  }
}

TEST_F(PlayerOutput, IsCheckedBeforeAnythingIsRead) {
  const ProgramResult result =
      run_player({"render", "missing.atlas", "-o", "x.png", "--stats", "x.png"}, folder.path());
  EXPECT_EQ(result.status, 2);
  const ProgramResult no_folder =
      run_program({SPLATLAS_PLAYER, "render", "missing.atlas", "-o", "nowhere/x.png"}, folder.path());
  EXPECT_EQ(no_folder.status, 1);
  EXPECT_EQ(no_folder.err, "splatlas-player: nowhere/x.png: cannot be written: there is no folder nowhere\n");
}

TEST_F(PlayerOutput, FailsOnAFullStandardOutput) {
  for (const Words& words : {Words{"verify", "a.png"},
                             {"info", "a.png"},
                             {"info", "a.png", "--json"},
                             {"--help"},
                             {"render", "--help"},
                             {"--version"}}) {
    const ProgramResult result = run_by_shell(kFullDevice, joined({SPLATLAS_PLAYER}, words), folder.path());
    EXPECT_EQ(result.status, 1) << words.front();
    EXPECT_EQ(result.err, "splatlas-player: standard output: cannot be written: No space left on device\n");
  }
}

}  // namespace
}  // namespace splatlas
