#include "bench/peak_memory.h"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(PeakMemory, CountsWhatWasHeldAtOnceAndStartsAnew) {
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  const Result<PeakMemory> first = PeakMemory::start();
  ASSERT_TRUE(first.has_value()) << first.error().message;
  for (int n = 1; n <= 2; ++n) {
    const std::vector<char> held(kBytes, static_cast<char>(n));
    ASSERT_EQ(held.back(), n);
  }
  const auto grown = first->grown_bytes();
  ASSERT_TRUE(grown.has_value());
  EXPECT_GT(*grown, kBytes - kBytes / 16);  // the system counts pages in batches
  EXPECT_LT(*grown, 2 * kBytes);            // consecutive, not simultaneous
  const Result<PeakMemory> second = PeakMemory::start();
  ASSERT_TRUE(second.has_value());
  EXPECT_LT(*second->grown_bytes(), kBytes);
}

}  // namespace
}  // namespace splatlas
