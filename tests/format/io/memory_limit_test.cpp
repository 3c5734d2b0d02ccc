#include "format/io/memory_limit.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace splatlas {
namespace {

TEST(MemoryLimit, IsHalfOfWhatTheProcessMayHave) {
  const std::uint64_t before = default_memory_limit();
  EXPECT_GT(before, 0u);
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit old{};
    ASSERT_EQ(::getrlimit(resource, &old), 0);
    const rlimit half{before / 2, old.rlim_max};
    ASSERT_EQ(::setrlimit(resource, &half), 0);
    const std::uint64_t limited = default_memory_limit();  // no other call here: it might allocate
    ::setrlimit(resource, &old);
    EXPECT_EQ(limited, before / 4);
    EXPECT_EQ(default_memory_limit(), before);
  }
}

}  // namespace
}  // namespace splatlas
