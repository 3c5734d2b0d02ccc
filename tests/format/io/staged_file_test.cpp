#include "format/io/staged_file.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <functional>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;

/// From now on this process cannot create unnamed files, as on many network file systems.
void deny_unnamed_files() {
  constexpr std::uint32_t kFlag = O_TMPFILE & ~O_DIRECTORY;
  const std::array filter{
      sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_openat, 0, 3),
      sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args) + 2 * sizeof(__u64)),
      sock_filter BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, kFlag, 0, 1),
      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EOPNOTSUPP),
      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog program{filter.size(), const_cast<sock_filter*>(filter.data())};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) ::_exit(126);
  if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) ::_exit(126);
}

bool create(StagedFile& file, const std::filesystem::path& folder, mode_t mode) {
  FolderHandle handle;
  return handle.open(folder) && file.create(std::move(handle), mode);
}

/// The wait status of a process that runs `body`, without unnamed files if `named`.
int in_process(bool named, const std::function<void()>& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (named) deny_unnamed_files();
    body();
    ::_exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

/// Both ways of staging: without a name, and with a random one.
struct StagedFileTest : ::testing::TestWithParam<bool> {
  TemporaryFolder folder;

  [[nodiscard]] bool is_named() const { return GetParam(); }
  [[nodiscard]] std::size_t expected_names() const { return is_named() ? 1 : 0; }
  void put(const std::string& name) const { std::ofstream(folder.path() / name) << "old"; }
  static void fill(const StagedFile& file) { ASSERT_EQ(::write(file.descriptor(), "new", 3), 3); }
};
INSTANTIATE_TEST_SUITE_P(Staging, StagedFileTest, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "Named" : "Unnamed"; });

TEST_P(StagedFileTest, HasItsNameOnlyOncePublished) {
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path(), 0666));
                         fill(file);
                         ASSERT_EQ(folder.names().size(), expected_names());
                         if (is_named()) {
                           EXPECT_THAT(folder.names()[0], MatchesRegex("\\.splatlas-[0-9a-f]{32}"));
                         }
                         EXPECT_EQ(read_bytes(file.path()), "new");
                         ASSERT_TRUE(file.publish(file.folder(), "out"));
                         EXPECT_THAT(folder.names(), ElementsAre("out"));
                         EXPECT_EQ(read_bytes(folder.path() / "out"), "new");
                       }),
            0);
  EXPECT_THAT(folder.names(), ElementsAre("out"));
}

TEST_P(StagedFileTest, ReplacesAnOldFile) {
  put("out");
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path(), 0600));
                         fill(file);
                         ASSERT_TRUE(file.publish(file.folder(), "out"));
                       }),
            0);
  EXPECT_THAT(folder.names(), ElementsAre("out"));
  EXPECT_EQ(read_bytes(folder.path() / "out"), "new");
}

TEST_P(StagedFileTest, VanishesUnlessPublished) {
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path(), 0600));
                       }),
            0);
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST_P(StagedFileTest, LeavesNothingThatTheKernelCannotRemoveWhenKilled) {
  const int status = in_process(is_named(), [&] {
    StagedFile file;
    ASSERT_TRUE(create(file, folder.path(), 0600));
    std::raise(SIGKILL);
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_EQ(folder.names().size(), expected_names());
}

TEST_P(StagedFileTest, IsRemovedByInterrupts) {
  const int status = in_process(is_named(), [&] {
    install_interrupt_handlers();
    StagedFile file;
    ASSERT_TRUE(create(file, folder.path(), 0600));
    std::raise(SIGTERM);
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST_P(StagedFileTest, DoesNotReplaceAFolder) {
  std::filesystem::create_directory(folder.path() / "out");
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path(), 0600));
                         EXPECT_FALSE(file.publish(file.folder(), "out"));
                         EXPECT_EQ(errno, EISDIR);
                         EXPECT_THAT(folder.names(), ElementsAre("out"));
                       }),
            0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "out"));
}

/// Another program takes the random name: its file is not ours to remove.
TEST(StagedFileOfOthersTest, Stays) {
  const TemporaryFolder folder;
  EXPECT_EQ(in_process(true,
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path(), 0600));
                         const auto name = folder.path() / folder.names().at(0);
                         std::filesystem::remove(name);
                         std::ofstream(name) << "thesis";
                       }),
            0);
  ASSERT_EQ(folder.names().size(), 1u);
  EXPECT_EQ(read_bytes(folder.path() / folder.names()[0]), "thesis");
}

/// The folder is moved, and another one takes its path.
TEST_P(StagedFileTest, StaysInItsFolder) {
  std::filesystem::create_directory(folder.path() / "mine");
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         StagedFile file;
                         ASSERT_TRUE(create(file, folder.path() / "mine", 0600));
                         std::filesystem::rename(folder.path() / "mine", folder.path() / "moved");
                         std::filesystem::create_directory(folder.path() / "mine");
                         ASSERT_TRUE(file.publish(file.folder(), "out"));
                       }),
            0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "mine"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "moved" / "out"));
}

TEST_P(StagedFileTest, TellsWhyItCannotBeCreated) {
  StagedFile file;
  EXPECT_FALSE(create(file, folder.path() / "none", 0600));
  EXPECT_EQ(errno, ENOENT);
  put("file");
  StagedFile in_file;
  EXPECT_FALSE(create(in_file, folder.path() / "file", 0600));
  EXPECT_EQ(errno, ENOTDIR);
}

TEST_P(StagedFileTest, TellsWhetherThereAreUnnamedFiles) {
  EXPECT_EQ(in_process(is_named(),
                       [&] {
                         FolderHandle handle;
                         ASSERT_TRUE(handle.open(folder.path()));
                         EXPECT_EQ(handle.supports_unnamed_files(), !is_named());
                         EXPECT_EQ(handle.duplicate().supports_unnamed_files(), !is_named());
                       }),
            0);
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(RandomNameTest, RepeatsNoName) {
  EXPECT_NE(random_name(), random_name());
  EXPECT_THAT(random_name(), MatchesRegex("\\.splatlas-[0-9a-f]{32}"));
}

TEST(FolderHandleTest, CreatesAFolderInAnother) {
  const TemporaryFolder folder;
  FolderHandle parent, made, again;
  ASSERT_TRUE(parent.open(folder.path()));
  ASSERT_TRUE(made.create(parent, "made", 0700));
  EXPECT_TRUE(made.sync());
  EXPECT_FALSE(again.create(parent, "made", 0700));
  EXPECT_EQ(errno, EEXIST);
  EXPECT_THAT(folder.names(), ElementsAre("made"));
}

}  // namespace
}  // namespace splatlas
