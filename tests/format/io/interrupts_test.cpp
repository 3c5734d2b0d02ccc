// Signals while files and folders are unfinished.
#include <csignal>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "format/io/output_file.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct InterruptsTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "out";

  /// The signal that ends a process with handlers that runs `body`; 0 for none.
  static int signal_ending(const std::function<void()>& body) {
    const pid_t child = ::fork();
    if (child == 0) {
      install_interrupt_handlers();
      body();
      ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
};

TEST_F(InterruptsTest, RemoveEverythingUnfinished) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(signal_ending([&] {
                std::vector<OutputFile> files;
                for (int n = 0; n < 40; ++n) files.push_back(OutputFile::create(path).value());
                OutputFolder masks = OutputFolder::create(folder.path() / "masks").value();
                const auto empty = [](OutputFile&) -> Result<void> { return {}; };
                if (!masks.add("done", empty) || folder.names().size() != 41) ::_exit(1);
                (void)masks.add("unfinished", [&](OutputFile&) -> Result<void> {
                  std::raise(signal);
                  return {};
                });
              }),
              signal);
    EXPECT_THAT(folder.names(), IsEmpty());
  }
}

TEST_F(InterruptsTest, LeaveWhatIsCommitted) {
  EXPECT_EQ(signal_ending([&] {
              if (!write_file(path, {})) return;
              std::raise(SIGTERM);
            }),
            SIGTERM);
  EXPECT_THAT(folder.names(), ElementsAre("out"));
}

TEST_F(InterruptsTest, StayIgnored) {
  std::signal(SIGHUP, SIG_IGN);
  EXPECT_EQ(signal_ending([] { std::raise(SIGHUP); }), 0);
  std::signal(SIGHUP, SIG_DFL);
}

}  // namespace
}  // namespace splatlas
