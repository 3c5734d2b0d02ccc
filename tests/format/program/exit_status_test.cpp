#include "format/program/exit_status.h"

#include <new>
#include <stdexcept>

#include <gmock/gmock.h>

#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

Result<void> out_of_memory() {
  throw std::bad_alloc();
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
