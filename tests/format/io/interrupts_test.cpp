#include "format/io/interrupts.h"

#include <csignal>
#include <functional>
#include <optional>
#include <vector>

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

TEST_F(InterruptsTest, RemoveEveryFileInTheMaking) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(signal_ending([&] {
                std::vector<OutputFile> files;
                for (int n = 0; n < 3; ++n) files.push_back(OutputFile::create(path).value());
                std::raise(signal);
              }),
              signal);
    EXPECT_THAT(folder.names(), IsEmpty());
  }
}

TEST_F(InterruptsTest, LongWorkIsToldThatOneWaits) {
  EXPECT_EQ(signal_ending([&] {
              const DeferInterrupts deferred;
              const bool before = interrupt_waits();
              std::raise(SIGINT);
              if (before || !interrupt_waits()) ::_exit(1);
            }),
            SIGINT);
}

TEST_F(InterruptsTest, LeaveWhatIsCommitted) {
  EXPECT_EQ(signal_ending([&] {
              OutputFile file = OutputFile::create(path).value();
              if (!file.commit()) return;
              std::raise(SIGTERM);
            }),
            SIGTERM);
  EXPECT_THAT(folder.names(), ElementsAre("out"));
}

TEST_F(InterruptsTest, Wait) {
  EXPECT_EQ(signal_ending([&] {
              std::optional<DeferInterrupts> outer(std::in_place);
              {
                const DeferInterrupts inner;
                std::raise(SIGINT);
              }
              if (!write_file(path, {})) ::_exit(1);
              outer.reset();
            }),
            SIGINT);
  EXPECT_THAT(folder.names(), ElementsAre("out"));
}

TEST_F(InterruptsTest, StayIgnored) {
  std::signal(SIGHUP, SIG_IGN);
  EXPECT_EQ(signal_ending([] { std::raise(SIGHUP); }), 0);
  std::signal(SIGHUP, SIG_DFL);
}

TEST_F(InterruptsTest, MoreFilesThanThereAreSlotsDoNoHarm) {
  EXPECT_EQ(signal_ending([&] {
              std::vector<OutputFile> files;
              for (int n = 0; n < 40; ++n) files.push_back(OutputFile::create(path).value());
              files.clear();
              std::vector<OutputFile> again;
              for (int n = 0; n < 16; ++n) again.push_back(OutputFile::create(path).value());
              std::raise(SIGINT);
            }),
            SIGINT);
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace splatlas
