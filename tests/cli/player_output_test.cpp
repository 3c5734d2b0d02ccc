// Output files of splatlas-player: complete or absent, and never over an input.

#include <filesystem>

#include <gmock/gmock.h>

#include "tests/cli/phantom_atlas.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

const std::string kFont = "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf";

TEST(PlayerOutput, IsNeverTheFont) {
  const TemporaryFolder fonts;
  const std::string font = fonts.file("font.png"), before = read_bytes(kFont);
  fs::copy_file(kFont, font);
  fs::create_symlink(font, fonts.file("link.json"));
  const Words annotated{"render", phantom_atlas(), "--annotate", "caption", "--caption", "A", "--font", font};
  for (const Words& words : {Words{"-o", font},
                             {"-o", "x.png", "--stats", fonts.file("link.json")},
                             {"-o", "x.png", "--ids", font}}) {
    const ProgramResult result = run_player(joined(annotated, words), fonts.path());
    EXPECT_EQ(result.status, 2) << words.back();
    EXPECT_EQ(result.err,
              "splatlas-player: " + words.back() + ": is an input (" + font + "); write to another file\n");
    EXPECT_TRUE(read_bytes(font) == before);
    EXPECT_THAT(fonts.names(), ElementsAre("font.png", "link.json"));
  }
}

TEST(PlayerOutput, FailsOnAFullStandardOutput) {
  for (const Words& words : {Words{"verify", phantom_atlas()},
                             {"info", phantom_atlas()},
                             {"info", phantom_atlas(), "--json"},
                             {"--help"},
                             {"render", "--help"},
                             {"--version"}}) {
    const ProgramResult result =
        run_by_shell(kFullDevice, joined({SPLATLAS_PLAYER}, words), phantom_folder().path());
    EXPECT_EQ(result.status, 1) << words.front();
    EXPECT_EQ(result.err, "splatlas-player: standard output: cannot be written: No space left on device\n");
  }
}

}  // namespace
}  // namespace splatlas
