#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "format/io/output_file.h"
#include "tests/format/ordinary_user.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

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

struct CheckWritableTest : ::testing::Test {
  TemporaryFolder folder;
  fs::path path = folder.path() / "out";

  /// The reason why a path is not writable; "" if it is.
  static std::string reason(const fs::path& of, Result<void> (*check)(const fs::path&)) {
    const Result<void> checked = check(of);
    if (checked) return "";
    EXPECT_EQ(checked.error().code, ErrorCode::kFailed);
    const std::string start = of.string() + ": cannot be written: ";
    EXPECT_TRUE(checked.error().message.starts_with(start)) << checked.error().message;
    return checked.error().message.substr(start.size());
  }
  static std::string file(const fs::path& of) { return reason(of, check_writable_file); }
  static std::string folder_at(const fs::path& of) { return reason(of, check_writable_folder); }
};

TEST_F(CheckWritableTest, NewAndOldFilesCanBeWrittenAndStayAsTheyAre) {
  EXPECT_EQ(file(path), "");
  EXPECT_TRUE(folder.names().empty());
  std::ofstream(path) << "old";
  EXPECT_EQ(file(path), "");
  fs::create_symlink("new", folder.path() / "link");
  EXPECT_EQ(file(folder.path() / "link"), "");
  EXPECT_EQ(fs::file_size(path), 3u);
  EXPECT_FALSE(fs::exists(folder.path() / "new"));
}

TEST_F(CheckWritableTest, OutputsHaveNames) {
  EXPECT_THAT(check_writable_file(""), FailsWith(ErrorCode::kUsage, "\"\": the output must have a name"));
}

TEST_F(CheckWritableTest, WhatIsNoFileIsTold) {
  EXPECT_EQ(file(folder.path()), "it is a folder");
  EXPECT_EQ(file(path / ""), "it is a folder");
  EXPECT_EQ(file("/dev/null"), "it is not a regular file");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(file(path), "it is not a regular file");
}

TEST_F(CheckWritableTest, MissingFoldersAreNamed) {
  const fs::path none = folder.path() / "none";
  EXPECT_EQ(file(none / "out"), "there is no folder " + none.string());
  EXPECT_EQ(folder_at(none / "out"), "there is no folder " + none.string());
  fs::create_symlink(none / "out", path);
  EXPECT_EQ(file(path), "there is no folder " + none.string());
}

TEST_F(CheckWritableTest, NamesThatNoFileCanHaveAreTold) {
  const fs::path longest = folder.path() / std::string(256, 'n');
  EXPECT_EQ(file(longest), "File name too long");
  EXPECT_EQ(folder_at(longest), "File name too long");
}

TEST_F(CheckWritableTest, FilesThatMayNotBeWrittenToAreTold) {
  std::ofstream(path) << "old";
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  ASSERT_TRUE(give_to_ordinary_user(folder.path().c_str()));
  const OrdinaryUser user;
  EXPECT_EQ(file(path), "Permission denied");
}

/// The effective user decides, as for the later write.
TEST_F(CheckWritableTest, FoldersThatMayNotBeWrittenToAreTold) {
  ASSERT_TRUE(give_to_ordinary_user(folder.path().c_str()));
  ASSERT_EQ(::chmod(folder.path().c_str(), 0555), 0);
  const OrdinaryUser user;
  EXPECT_EQ(file(path), "Permission denied");
  EXPECT_EQ(folder_at(path), "Permission denied");
}

TEST_F(CheckWritableTest, FoldersMustBeNewOrEmpty) {
  EXPECT_EQ(folder_at(path), "");
  EXPECT_EQ(folder_at(path / ""), "");
  fs::create_directory(path);
  EXPECT_EQ(folder_at(path), "");
  std::ofstream(path / "mask.nrrd") << "x";
  EXPECT_EQ(folder_at(path), "it exists and is not an empty folder; name a new one");
  EXPECT_EQ(folder_at(path / "mask.nrrd"), "it exists and is not an empty folder; name a new one");
  EXPECT_THAT(folder.names(), ElementsAre("out"));
}

}  // namespace
}  // namespace splatlas
