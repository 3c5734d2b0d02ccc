#include "format/output_file.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/format/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
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
  static std::string read(const std::filesystem::path& from) {
    std::ifstream file(from, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(OutputFileTest, WritesAndReplaces) {
  EXPECT_EQ(write(path, "one"), "");
  EXPECT_EQ(read(path), "one");
  EXPECT_EQ(write(path, std::string(3'000'000, 'x')), "");
  EXPECT_EQ(read(path), std::string(3'000'000, 'x'));
  EXPECT_EQ(write(path, ""), "");
  EXPECT_EQ(read(path), "");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

TEST_F(OutputFileTest, KeepsPermissionsOfTheOldFile) {
  ASSERT_EQ(write(path, "one"), "");
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  ASSERT_EQ(write(path, "two"), "");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0640});
}

TEST_F(OutputFileTest, NewFilesFollowTheMask) {
  const mode_t old_mask = ::umask(027);
  EXPECT_EQ(write(path, "one"), "");
  ::umask(old_mask);
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0640});
}

TEST_F(OutputFileTest, FollowsLinks) {
  ASSERT_EQ(write(path, "one"), "");
  const auto link = folder.path() / "link";
  std::filesystem::create_symlink("out.atlas", link);
  EXPECT_EQ(write(link, "two"), "");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read(path), "two");
}

TEST_F(OutputFileTest, TakesNamesAsLongAsTheFileSystemAllows) {
  EXPECT_EQ(write(folder.path() / std::string(255, 'n'), "one"), "");
}

TEST_F(OutputFileTest, RefusesWhatIsNotAFile) {
  EXPECT_THAT(write(folder.path(), "x"), HasSubstr("it is a folder"));
  EXPECT_THAT(write("/dev/null", "x"), HasSubstr("it is not a regular file"));
  EXPECT_THAT(write(folder.path() / "none" / "out.atlas", "x"), HasSubstr("No such file or directory"));
  EXPECT_THAT(write(path / "", "x"), HasSubstr("cannot be written"));
  ASSERT_EQ(write(path, "one"), "");
  EXPECT_THAT(write(path / "below", "x"), HasSubstr("Not a directory"));
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

/// A limit on the size of files stands for a full disk: the write after it comes up short, then fails.
TEST_F(OutputFileTest, AFullDiskLeavesTheOldFileAndNoTemporary) {
  ASSERT_EQ(write(path, "old"), "");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{5000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = write(path, std::string(10'000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_EQ(read(path), "old");
  EXPECT_THAT(folder.names(), ElementsAre("out.atlas"));
}

}  // namespace
}  // namespace splatlas
