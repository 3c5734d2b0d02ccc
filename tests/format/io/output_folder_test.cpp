#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/io/output_file.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct OutputFolderTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "masks";

  static void put(const std::filesystem::path& file) { std::ofstream(file) << "x"; }
  static void add(OutputFolder& to, const std::string& name) {
    const Result<void> added =
        to.add(name, [&](OutputFile& file) { return file.write(std::as_bytes(std::span(name))); });
    ASSERT_TRUE(added) << message_of(added);
  }
};

TEST_F(OutputFolderTest, AppearsWhole) {
  for (const bool exists : {false, true}) {
    if (exists) std::filesystem::create_directory(path);
    auto made = OutputFolder::create(path / "");
    ASSERT_TRUE(made);
    add(*made, "one.nii.gz");
    add(*made, "two.nii.gz");
    EXPECT_EQ(std::filesystem::exists(path), exists);
    EXPECT_FALSE(std::filesystem::exists(path / "one.nii.gz"));
    const Result<void> committed = made->commit();
    ASSERT_TRUE(committed) << message_of(committed);
    EXPECT_EQ(read_bytes(path / "one.nii.gz"), "one.nii.gz");
    EXPECT_EQ(read_bytes(path / "two.nii.gz"), "two.nii.gz");
    EXPECT_THAT(folder.names(), ElementsAre("masks"));
    std::filesystem::remove_all(path);
  }
}

TEST_F(OutputFolderTest, HoldsMoreFilesThanMayBeOpen) {
  constexpr int kFiles = 400;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit small{300, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &small), 0);
  auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  for (int n = 0; n < kFiles; ++n) add(*made, std::to_string(n));
  ASSERT_TRUE(made->commit());
  ::setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path), {}), kFiles);
  EXPECT_EQ(read_bytes(path / "399"), "399");
}

TEST_F(OutputFolderTest, WhatIsNotCommittedIsRemoved) {
  {
    auto made = OutputFolder::create(path);
    ASSERT_TRUE(made);
    add(*made, "one.nii.gz");
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

/// Somebody else puts a file into the folder with the random name. It is not ours to remove.
TEST_F(OutputFolderTest, LeavesFilesOfOthers) {
  {
    auto made = OutputFolder::create(path);
    ASSERT_TRUE(made);
    add(*made, "one.nii.gz");
    ASSERT_EQ(folder.names().size(), 1u);
    put(folder.path() / folder.names()[0] / "thesis");
  }
  ASSERT_EQ(folder.names().size(), 1u);
  const auto left = folder.path() / folder.names()[0];
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(left), {}), 1);
  EXPECT_EQ(read_bytes(left / "thesis"), "x");
}

TEST_F(OutputFolderTest, ReplacesNothing) {
  put(path);
  EXPECT_THAT(message_of(OutputFolder::create(path)),
              EndsWith("masks: cannot be written: it exists and is not an empty folder; name a new one"));
  std::filesystem::remove(path);
  auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  add(*made, "one.nii.gz");
  std::filesystem::create_directory(path);
  put(path / "other");  // meanwhile
  EXPECT_THAT(message_of(made->commit()), HasSubstr("masks: cannot be written: Directory not empty"));
  made = fail(ErrorCode::kFailed, "done");
  EXPECT_THAT(folder.names(), ElementsAre("masks"));
  EXPECT_EQ(read_bytes(path / "other"), "x");
}

TEST_F(OutputFolderTest, KeepsThePermissionsOfAnEmptyFolder) {
  std::filesystem::create_directory(path);
  ASSERT_EQ(::chmod(path.c_str(), 02750), 0);
  auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  ASSERT_TRUE(made->commit());
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0750});
}

}  // namespace
}  // namespace splatlas
