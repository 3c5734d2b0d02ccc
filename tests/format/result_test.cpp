#include "format/result.h"

#include <memory>

#include <gtest/gtest.h>

#include "format/result_macros.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

Result<std::unique_ptr<int>> make(bool works) {
  if (!works) return fail(ErrorCode::kLimit, "too much");
  return std::make_unique<int>(7);
}

Result<void> check(bool works) {
  if (!works) return fail(ErrorCode::kUsage, "wrong");
  return {};
}

Result<int> both(bool first, bool second, int& reached) {
  SPLATLAS_RETURN_IF_ERROR(check(first));
  reached = 1;
  SPLATLAS_ASSIGN_OR_RETURN(const std::unique_ptr<int> value, make(second));  // moved, not copied
  reached = 2;
  return *value;
}

TEST(Result, MacrosPassErrorsOn) {
  int reached = 0;
  EXPECT_THAT(both(false, true, reached), FailsWith(ErrorCode::kUsage, "wrong"));
  EXPECT_EQ(reached, 0);

  EXPECT_THAT(both(true, false, reached), FailsWith(ErrorCode::kLimit, "too much"));
  EXPECT_EQ(reached, 1);

  const auto third = both(true, true, reached);
  ASSERT_TRUE(third);
  EXPECT_EQ(*third, 7);
  EXPECT_EQ(reached, 2);
}

}  // namespace
}  // namespace splatlas
