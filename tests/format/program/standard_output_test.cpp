#include "format/program/standard_output.h"

#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

Result<void> out_of_memory() {
  throw std::bad_alloc();
}

/// Redirects standard output during its lifetime. Expectations would print into it.
class StandardOutputTo {
 public:
  explicit StandardOutputTo(const std::filesystem::path& path) {
    std::fflush(stdout);
    go_to(path);
  }
  ~StandardOutputTo() {
    std::fflush(stdout);
    std::clearerr(stdout);
    ::dup2(own_, STDOUT_FILENO);
    ::close(own_);
  }
  StandardOutputTo(const StandardOutputTo&) = delete;
  StandardOutputTo& operator=(const StandardOutputTo&) = delete;

  static void go_to(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::close(file);
  }

 private:
  int own_ = ::dup(STDOUT_FILENO);
};

struct StandardOutputTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "said";
};

TEST_F(StandardOutputTest, IsHandedOnAtOnce) {
  std::string message, at_once;
  {
    const StandardOutputTo file(path);
    message = message_of(print_text(PrintableText("some text")));
    at_once = read_bytes(path);
  }
  EXPECT_EQ(message, "");
  EXPECT_EQ(at_once, "some text");
}

TEST_F(StandardOutputTest, AFullDiskIsTold) {
  for (const std::size_t bytes : {10, 1'000'000}) {  // smaller and larger than the buffer
    Result<void> printed, finished;
    {
      std::filesystem::remove(path);
      const StandardOutputTo full("/dev/full");
      printed = print_text(PrintableText("{}", std::string(bytes, 'x')));
      StandardOutputTo::go_to(path);
      finished = finish_standard_output();
    }
    ASSERT_FALSE(printed);
    EXPECT_EQ(printed.error().code, ErrorCode::kFailed);
    EXPECT_EQ(printed.error().message, "standard output: cannot be written: No space left on device");
    // An earlier loss counts even with space available again.
    EXPECT_EQ(message_of(finished), "standard output: cannot be written: an earlier write failed");
  }
}

TEST(ExitStatus, ExceptionsOfWorkOnAFileNameTheFile) {
  EXPECT_TRUE(run_on_file("a.atlas", "select less", [] { return Result<void>(); }));
  EXPECT_THAT(run_on_file("a.atlas", "select less", out_of_memory),
              FailsWith(ErrorCode::kLimit, "a.atlas: out of memory; select less"));
  EXPECT_THAT(run_on_file("a.atlas", "", []() -> Result<void> { throw std::runtime_error("it broke"); }),
              FailsWith(ErrorCode::kFailed, "a.atlas: it broke"));
  EXPECT_THAT(run_on_file("a.atlas", "", []() -> Result<void> { return fail(ErrorCode::kUsage, "--x"); }),
              FailsWith(ErrorCode::kUsage, "--x"));
}

TEST(ExitStatus, ProgramsPrintOneSafeLine) {
  CaptureStderr();
  const int failed =
      run_main("tool", []() -> Result<void> { return fail(ErrorCode::kNotFound, "a\nb\x1b"); });
  const int thrown = run_main("tool", []() -> Result<void> { throw std::runtime_error("c\nd\xe2\x80\x8f"); });
  const int exhausted = run_main("tool", out_of_memory);
  EXPECT_EQ(GetCapturedStderr(),
            "tool: a?b?\ntool: c?d?\ntool: out of memory; free memory, or raise the program's limit\n");
  EXPECT_EQ(failed, 4);
  EXPECT_EQ(thrown, 1);
  EXPECT_EQ(exhausted, 1);
}

}  // namespace
}  // namespace splatlas
