#include "format/system/output_folder.h"

#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

struct OutputFolderTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "masks";

  static void put(const std::filesystem::path& file) { std::ofstream(file) << "x"; }
};

TEST_F(OutputFolderTest, AppearsWhole) {
  for (const bool there : {false, true}) {  // an empty folder is replaced
    std::filesystem::remove_all(path);
    if (there) std::filesystem::create_directory(path);
    auto made = OutputFolder::create(path / "");
    ASSERT_TRUE(made) << made.error().message;
    put(made->temporary() / "one.nii.gz");
    EXPECT_FALSE(std::filesystem::exists(path / "one.nii.gz"));
    ASSERT_TRUE(made->commit());
    EXPECT_TRUE(std::filesystem::exists(path / "one.nii.gz"));
    EXPECT_THAT(folder.names(), ElementsAre("masks"));
  }
}

TEST_F(OutputFolderTest, WhatIsNotCommittedIsRemoved) {
  {
    const auto made = OutputFolder::create(path);
    ASSERT_TRUE(made);
    put(made->temporary() / "one.nii.gz");
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(OutputFolderTest, ReplacesNothing) {
  put(path);
  EXPECT_THAT(OutputFolder::create(path).error().message,
              EndsWith("masks: cannot be written: it exists and is not an empty folder"));
  std::filesystem::remove(path);
  auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  std::filesystem::create_directory(path);
  put(path / "other");  // meanwhile
  EXPECT_THAT(message_of(made->commit()), HasSubstr("masks: cannot be written: Directory not empty"));
}

/// All candidate names are taken by entries that are not stale.
TEST_F(OutputFolderTest, WhatCannotBeMadeTellsWhy) {
  const auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  const std::string name = made->temporary().string();
  const std::size_t digits = name.rfind('-') + 1;
  const unsigned long number = std::stoul(name.substr(digits));
  for (unsigned long n = 1; n <= 100; ++n)
    std::filesystem::create_symlink("nowhere", fmt::format("{}{}", name.substr(0, digits), number + n));
  EXPECT_EQ(message_of(OutputFolder::create(path)), path.string() + ": cannot be written: File exists");
}

TEST_F(OutputFolderTest, RemovesWhatKilledWritersLeft) {
  const auto stale = folder.path() / (".splatlas-" + std::to_string(::getpid()) + "-4000000");
  std::filesystem::create_directory(stale);
  put(stale / "one.nii.gz");
  auto made = OutputFolder::create(path);
  ASSERT_TRUE(made);
  ASSERT_TRUE(made->commit());
  EXPECT_THAT(folder.names(), ElementsAre("masks"));
}

}  // namespace
}  // namespace splatlas
