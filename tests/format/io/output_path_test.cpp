#include "format/io/output_path.h"

#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct OutputPathTest : ::testing::Test {
  TemporaryFolder folder;
  fs::path atlas = folder.path() / "a.atlas", picture = folder.path() / "x.png";

  OutputPathTest() { std::ofstream(atlas) << "atlas"; }

  static void expect_refused(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs,
                             const std::string& text) {
    EXPECT_THAT(check_outputs(outputs, inputs), FailsWith(ErrorCode::kUsage, HasSubstr(text))) << text;
  }
};

TEST_F(OutputPathTest, DifferentFilesAreTaken) {
  EXPECT_TRUE(check_outputs(std::vector{picture, folder.path() / "stats.json"}, std::vector{atlas}));
  EXPECT_TRUE(check_outputs(std::vector<fs::path>{"", ""}, std::vector<fs::path>{""}));
  EXPECT_TRUE(check_outputs(std::vector{folder.path() / "none" / "a.atlas"}, std::vector{atlas}));
}

TEST_F(OutputPathTest, AnInputIsRefusedByAnyPath) {
  fs::create_symlink("a.atlas", folder.path() / "link");
  fs::create_hard_link(atlas, folder.path() / "hard.png");
  fs::create_directory(folder.path() / "sub");
  for (const fs::path& same : {atlas, folder.path() / "link", folder.path() / "hard.png",
                               folder.path() / "sub" / ".." / "a.atlas", fs::relative(atlas)}) {
    expect_refused({picture, same}, {atlas}, same.string() + ": is an input (");
  }
}

TEST_F(OutputPathTest, TheSameOutputTwiceIsRefusedBeforeItIsThere) {
  fs::create_symlink("x.png", folder.path() / "link");
  fs::create_directory_symlink(".", folder.path() / "here");
  for (const fs::path& same : {picture, folder.path() / "link", folder.path() / "." / "x.png",
                               folder.path() / "here" / "x.png", fs::relative(picture)}) {
    expect_refused({picture, "", same}, {atlas}, same.string() + ": is another output, too (");
  }
  EXPECT_FALSE(fs::exists(picture));
}

TEST_F(OutputPathTest, LinksAreFollowed) {
  const fs::path real = fs::canonical(folder.path());
  EXPECT_EQ(resolve_output(picture), real / "x.png");
  fs::create_directory(folder.path() / "sub");
  fs::create_symlink("../x.png", folder.path() / "sub" / "relative");
  fs::create_symlink(folder.path() / "sub" / "relative", folder.path() / "absolute");
  EXPECT_EQ(resolve_output(folder.path() / "absolute"), real / "x.png");
  fs::create_symlink("none/x.png", folder.path() / "broken");
  EXPECT_EQ(resolve_output(folder.path() / "broken"), folder.path() / "none" / "x.png");
}

}  // namespace
}  // namespace splatlas
