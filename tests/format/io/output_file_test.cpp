#include "format/io/output_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/format/ordinary_user.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::UnorderedElementsAre;

struct OutputFileTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "out.atlas";

  static std::string write(const std::filesystem::path& to, const std::string& text) {
    const auto written = write_file(to, std::as_bytes(std::span(text)));
    if (written) return "";
    EXPECT_EQ(written.error().code, ErrorCode::kFailed);
    EXPECT_THAT(written.error().message, HasSubstr(to.string() + ": cannot be written: "));
    return written.error().message;
  }
};

TEST_F(OutputFileTest, WritesAndReplaces) {
  EXPECT_EQ(write(path, "one"), "");
  EXPECT_EQ(read_bytes(path), "one");
  EXPECT_EQ(write(path, std::string(3'000'000, 'x')), "");
  EXPECT_EQ(read_bytes(path), std::string(3'000'000, 'x'));
  EXPECT_EQ(write(path, ""), "");
  EXPECT_EQ(read_bytes(path), "");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

TEST_F(OutputFileTest, NewFilesFollowTheMask) {
  const mode_t old_mask = ::umask(027);
  EXPECT_EQ(write(path, "one"), "");
  ::umask(old_mask);
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0640});
}

TEST_F(OutputFileTest, LeavesWhatMayNotBeWrittenTo) {
  ASSERT_EQ(write(path, "one"), "");
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  ASSERT_TRUE(give_to_ordinary_user(folder.path().c_str()));
  {
    const OrdinaryUser user;
    EXPECT_THAT(write(path, "two"), HasSubstr("Permission denied"));
  }
  EXPECT_EQ(read_bytes(path), "one");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

TEST_F(OutputFileTest, KeepsTheOwnerWhereThatMayBe) {
  ASSERT_EQ(write(path, "one"), "");
  struct stat before {};
  // Root may give the file away, others only to themselves.
  const uid_t owner = ::geteuid() == 0 ? 1234 : ::geteuid();
  ASSERT_EQ(::chown(path.c_str(), owner, static_cast<gid_t>(-1)), 0);
  ASSERT_EQ(::stat(path.c_str(), &before), 0);
  ASSERT_EQ(write(path, "two"), "");
  struct stat after {};
  ASSERT_EQ(::stat(path.c_str(), &after), 0);
  EXPECT_EQ(after.st_uid, owner);
  EXPECT_EQ(after.st_gid, before.st_gid);
  EXPECT_EQ(after.st_mode, before.st_mode);
}

/// The group may do more than others here; a new group must not.
TEST_F(OutputFileTest, GrantsAnotherGroupWhatOthersMayDo) {
  ASSERT_EQ(write(path, "one"), "");
  const bool root = ::geteuid() == 0;  // other users cannot create a file of a foreign group
  ASSERT_EQ(::chown(path.c_str(), root ? 1234 : ::geteuid(), root ? 1234 : ::getegid()), 0);
  ASSERT_EQ(::chmod(path.c_str(), 02676), 0);
  ASSERT_TRUE(give_to_ordinary_user(folder.path().c_str()));
  {
    const OrdinaryUser user;
    EXPECT_EQ(write(path, "two"), "");
  }
  EXPECT_EQ(read_bytes(path), "two");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms(root ? 0666 : 0676));
}

TEST_F(OutputFileTest, WritesIntoFoldersThatMayNotBeListed) {
  ASSERT_TRUE(give_to_ordinary_user(folder.path().c_str()));
  ASSERT_EQ(::chmod(folder.path().c_str(), 0300), 0);
  {
    const OrdinaryUser user;
    EXPECT_EQ(write(path, "one"), "");
  }
  EXPECT_EQ(read_bytes(path), "one");
}

/// Another user must not read the new content of a private file at any time.
TEST_F(OutputFileTest, IsPrivateBeforeCommitIfTheOldFileIs) {
  ASSERT_EQ(write(path, "one"), "");
  ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
  auto file = value_or_throw(OutputFile::create(path));
  EXPECT_EQ(std::filesystem::status(file.temporary()).permissions(), std::filesystem::perms{0600});
  ASSERT_TRUE(commit_files({&file, 1}));
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0600});
}

TEST_F(OutputFileTest, DropsSetuidSetgidAndStickyBits) {
  ASSERT_EQ(write(path, "one"), "");
  ASSERT_EQ(::chmod(path.c_str(), 07755), 0);
  ASSERT_EQ(write(path, "two"), "");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0755});
}

/// Simulates a disk that returns wrong bytes: the temporary changes after the write.
TEST_F(OutputFileTest, ReadsBackWhatItWrote) {
  ASSERT_EQ(write(path, "old"), "");
  const std::string text(3'000'000, 'x');
  for (const bool shorter : {false, true}) {
    auto file = value_or_throw(OutputFile::create(path));
    ASSERT_TRUE(file.write(std::as_bytes(std::span(text))));
    if (shorter) {
      std::filesystem::resize_file(file.temporary(), text.size() - 1);
    } else {
      std::fstream(file.temporary(), std::ios::in | std::ios::out | std::ios::binary).seekp(2'345'678) << 'y';
    }
    EXPECT_EQ(message_of(commit_files({&file, 1})),
              path.string() + ": cannot be written: other bytes come back from the disk than were written");
  }
  EXPECT_EQ(read_bytes(path), "old");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

TEST_F(OutputFileTest, FollowsLinks) {
  ASSERT_EQ(write(path, "one"), "");
  const auto link = folder.path() / "link";
  std::filesystem::create_symlink("out.atlas", link);
  EXPECT_EQ(write(link, "two"), "");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_bytes(path), "two");
}

TEST_F(OutputFileTest, TakesNamesAsLongAsTheFileSystemAllows) {
  EXPECT_EQ(write(folder.path() / std::string(255, 'n'), "one"), "");
}

TEST_F(OutputFileTest, LibrariesWriteToItsPath) {
  ASSERT_EQ(write(path, "old"), "");
  {
    auto file = OutputFile::create(path);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_THAT(file->temporary().filename().string(), MatchesRegex("\\.splatlas-[0-9a-f]{16}"));
    std::ofstream(file->temporary()) << "new";
    EXPECT_EQ(read_bytes(path), "old");
    ASSERT_TRUE(commit_files({&*file, 1}));
    EXPECT_EQ(read_bytes(path), "new");
    ASSERT_TRUE(file = OutputFile::create(path));
    EXPECT_EQ(folder.names().size(), 2u);
  }
  EXPECT_EQ(read_bytes(path), "new");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

/// A folder that appears at the target's path stays.
TEST_F(OutputFileTest, DoesNotReplaceAFolder) {
  {
    auto file = value_or_throw(OutputFile::create(path));
    std::filesystem::create_directory(path);
    EXPECT_THAT(message_of(commit_files({&file, 1})), HasSubstr("cannot be written: Is a directory"));
  }
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

TEST_F(OutputFileTest, OfSeveralNoneIsRenamedBeforeAllAreComplete) {
  ASSERT_EQ(write(path, "old"), "");
  for (const bool fails : {true, false}) {
    std::vector<OutputFile> files;
    for (const char* name : {"out.atlas", "stats.json"}) {
      auto file = value_or_throw(OutputFile::create(folder.path() / name));
      ASSERT_TRUE(file.write(std::as_bytes(std::span("new", 3))));
      files.push_back(std::move(file));
    }
    if (fails) std::ofstream(files[1].temporary()) << "newer";
    const auto committed = commit_files(files);
    EXPECT_EQ(committed.has_value(), !fails);
    if (fails) {
      EXPECT_THAT(committed.error().message, HasSubstr("stats.json: cannot be written: other bytes"));
      files.clear();
      EXPECT_EQ(read_bytes(path), "old");
      EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
    }
  }
  EXPECT_EQ(read_bytes(path), "new");
  EXPECT_EQ(read_bytes(folder.path() / "stats.json"), "new");
  EXPECT_THAT(folder.names(), UnorderedElementsAre("out.atlas", "stats.json"));
}

}  // namespace
}  // namespace splatlas
