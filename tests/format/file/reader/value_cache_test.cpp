#include "format/file/reader/value_cache.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

using Values = std::vector<std::byte>;

/// Groups of two classes with four bytes each; counts how often each is decoded.
struct ValueCacheTest : ::testing::Test {
  static constexpr std::size_t kGroups = 4;
  ValueCache held{kGroups, 10};  // two groups of which a class was taken each: 8 bytes
  std::vector<std::atomic<int>> decoded = std::vector<std::atomic<int>>(kGroups);

  static Values values_of(std::size_t group, std::size_t n) {
    return Values(4, static_cast<std::byte>(10 * group + n));
  }
  ValueCache::GroupValues decode(std::size_t group) {
    ++decoded[group];
    return {values_of(group, 0), values_of(group, 1)};
  }
  /// Takes an expected value. Returns the number of decodings of its group.
  int take(std::size_t group, std::size_t n) {
    const auto values = held.take(group, n, [&] { return decode(group); });
    EXPECT_EQ(values.value(), values_of(group, n));
    return decoded[group];
  }
};

TEST_F(ValueCacheTest, AGroupIsDecodedOnceForAllItsClasses) {
  EXPECT_EQ(take(0, 1), 1);
  EXPECT_EQ(take(0, 0), 1);
  EXPECT_EQ(take(0, 0), 2);  // all values were taken
  EXPECT_EQ(take(0, 0), 3);  // a second time: the other value stays held
  EXPECT_EQ(take(0, 1), 3);
}

TEST_F(ValueCacheTest, TheOldestGoWhereTheyHoldTooMuch) {
  EXPECT_EQ(take(0, 0), 1);  // 4 bytes are held
  EXPECT_EQ(take(1, 0), 1);  // 12 bytes, then 4 without group 0
  EXPECT_EQ(take(0, 1), 2);  // group 1 was dropped
  EXPECT_EQ(take(1, 1), 2);
}

TEST_F(ValueCacheTest, WhatWasTakenCountsNoLonger) {
  for (int round = 1; round <= 3; ++round) {
    EXPECT_EQ(take(0, 0), round);
    EXPECT_EQ(take(0, 1), round);
    EXPECT_EQ(take(1, 0), round);
    EXPECT_EQ(take(1, 1), round);
  }
}

TEST_F(ValueCacheTest, AGroupThatIsTooLargeIsHeldAllTheSame) {
  ValueCache few(kGroups, 1);
  const auto decode_0 = [&] { return decode(0); };
  EXPECT_EQ(few.take(0, 0, decode_0).value(), values_of(0, 0));
  EXPECT_EQ(few.take(0, 1, decode_0).value(), values_of(0, 1));
  EXPECT_EQ(decoded[0], 1);
}

TEST_F(ValueCacheTest, AGroupThatSomebodyIsAtStays) {
  EXPECT_EQ(take(0, 0), 1);
  const auto values = held.take(0, 0, [&] {
    std::thread([&] { EXPECT_EQ(take(1, 0), 1); }).join();  // 12 bytes: group 0 is in use
    return decode(0);                                       // but group 1 can be dropped: 4 and 8 bytes
  });
  EXPECT_EQ(values.value(), values_of(0, 0));
  EXPECT_EQ(take(0, 1), 2);
  EXPECT_EQ(take(1, 1), 2);
}

TEST_F(ValueCacheTest, FailuresChangeNothing) {
  const auto failing = [] { return fail(ErrorCode::kInvalidAtlas, "damaged"); };
  EXPECT_EQ(held.take(0, 0, failing).error().message, "damaged");
  EXPECT_EQ(take(0, 0), 1);
  EXPECT_EQ(held.take(0, 0, failing).error().message, "damaged");
  EXPECT_EQ(take(0, 1), 1);
}

}  // namespace
}  // namespace splatlas
