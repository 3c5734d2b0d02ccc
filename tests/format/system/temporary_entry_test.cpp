#include "format/system/temporary_entry.h"

#include <cerrno>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The id of a process that has ended.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

struct TemporaryEntryTest : ::testing::Test {
  TemporaryFolder folder;

  void put(const std::string& name) const { std::ofstream(folder.path() / name) << "half"; }
  static std::string name(pid_t process, const std::string& rest) {
    return ".splatlas-" + std::to_string(process) + rest;
  }
};

TEST_F(TemporaryEntryTest, IsRemovedUnlessRenamed) {
  {
    TemporaryEntry dropped, kept;
    ASSERT_TRUE(dropped.make(folder.path(), TemporaryEntry::Kind::kFile, ".tmp"));
    ASSERT_TRUE(kept.make(folder.path(), TemporaryEntry::Kind::kFile));
    EXPECT_EQ(folder.names().size(), 2u);
    ASSERT_TRUE(kept.rename_to(folder.path() / "kept"));
  }
  EXPECT_THAT(folder.names(), ElementsAre("kept"));
}

TEST_F(TemporaryEntryTest, FoldersAreRemovedWithWhatIsInThem) {
  {
    TemporaryEntry entry;
    ASSERT_TRUE(entry.make(folder.path(), TemporaryEntry::Kind::kFolder));
    std::ofstream(entry.path() / "mask.nii.gz") << "half";
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST_F(TemporaryEntryTest, WhatCannotBeMadeTellsWhy) {
  TemporaryEntry file, made;
  EXPECT_FALSE(file.make(folder.path() / "none", TemporaryEntry::Kind::kFile));
  EXPECT_EQ(errno, ENOENT);
  EXPECT_FALSE(made.make(folder.path() / "none", TemporaryEntry::Kind::kFolder));
  EXPECT_EQ(errno, ENOENT);
}

/// For example, containers that share a folder have equal process ids.
TEST_F(TemporaryEntryTest, NamesThatAreTakenArePassedOver) {
  for (const auto kind : {TemporaryEntry::Kind::kFile, TemporaryEntry::Kind::kFolder}) {
    TemporaryEntry first, second, third;
    ASSERT_TRUE(first.make(folder.path(), kind));
    const std::string before = first.path().filename().string();
    const unsigned long number = std::stoul(before.substr(before.rfind('-') + 1));
    const auto name_after = [&](unsigned long n) { return name(::getpid(), fmt::format("-{}", number + n)); };
    put(name_after(1));
    ASSERT_TRUE(second.make(folder.path(), kind));
    EXPECT_EQ(second.path().filename(), name_after(2));
    for (unsigned long n = 3; n < 103; ++n) put(name_after(n));
    EXPECT_FALSE(third.make(folder.path(), kind));
    EXPECT_EQ(errno, EEXIST);
  }
}

TEST_F(TemporaryEntryTest, StaleOnesOfDeadProcessesAreRemoved) {
  const pid_t dead = dead_process();
  put(name(dead, "-0.tmp"));
  put(name(dead, "-17.nii.gz"));
  put(name(::getpid(), "-123456.tmp"));  // of an earlier process with this id: unlocked
  std::filesystem::create_directory(folder.path() / name(dead, "-3"));
  put(name(dead, "-3/mask.nii.gz"));
  put("atlas");
  remove_stale_temporaries(folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("atlas"));
}

TEST_F(TemporaryEntryTest, WhatLivesOrIsOfOthersStays) {
  const pid_t dead = dead_process();
  const std::vector<std::string> others{name(1, "-0.tmp"),   // a live process
                                        name(dead, ".tmp"),  // not a name of a temporary
                                        name(dead, "-0x"),
                                        name(dead, "-"),
                                        name(-1, "-0.tmp"),
                                        ".splatlas-",
                                        ".splatlas-99999999999999-0.tmp",
                                        "splatlas-" + std::to_string(dead) + "-0.tmp"};
  for (const std::string& other : others) put(other);
  std::filesystem::create_symlink("nowhere", folder.path() / name(dead, "-4.tmp"));
  TemporaryEntry file, made;
  ASSERT_TRUE(file.make(folder.path(), TemporaryEntry::Kind::kFile, ".tmp"));
  ASSERT_TRUE(made.make(folder.path(), TemporaryEntry::Kind::kFolder));
  const auto before = folder.names();
  remove_stale_temporaries(folder.path());
  EXPECT_THAT(folder.names(), ::testing::UnorderedElementsAreArray(before));
  EXPECT_EQ(before.size(), others.size() + 3);
}

/// Only the lock decides, as process ids repeat between containers.
TEST_F(TemporaryEntryTest, WhatIsLockedStaysWhateverItsProcess) {
  TemporaryEntry entry;
  ASSERT_TRUE(entry.make(folder.path(), TemporaryEntry::Kind::kFile, ".tmp"));
  const std::string foreign = name(dead_process(), "-0.tmp");
  ASSERT_TRUE(entry.rename_to(folder.path() / foreign));
  remove_stale_temporaries(folder.path());
  EXPECT_THAT(folder.names(), ElementsAre(foreign));
}

TEST_F(TemporaryEntryTest, FollowsAnotherFileThatWasPutThere) {
  TemporaryEntry entry;
  ASSERT_TRUE(entry.make(folder.path(), TemporaryEntry::Kind::kFile, ".ply"));
  std::filesystem::remove(entry.path());
  EXPECT_FALSE(entry.follow_name());
  put(entry.path().filename().string());
  ASSERT_TRUE(entry.follow_name());
  char byte = 0;
  EXPECT_EQ(::pread(entry.descriptor(), &byte, 1, 0), 1);
  EXPECT_EQ(byte, 'h');
}

TEST_F(TemporaryEntryTest, FoldersThatAreNotThereHoldNoStaleOnes) {
  remove_stale_temporaries(folder.path() / "none");
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace splatlas
