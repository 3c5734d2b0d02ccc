#include "bench/measure.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(Median, IsTheMiddleOne) {
  EXPECT_EQ(median(std::vector<double>{}), 0);
  EXPECT_EQ(median(std::vector<double>{7}), 7);
  EXPECT_EQ(median(std::vector<double>{9, 1, 100}), 9);
  EXPECT_EQ(median(std::vector<double>{9, 1, 100, 3}), 6);
}

/// Wall clock and CPU time.
auto elapsed(double wall_ms, double cpu_ms) {
  return testing::AllOf(testing::Field(&Elapsed::wall_ms, wall_ms), testing::Field(&Elapsed::cpu_ms, cpu_ms));
}

TEST(Median, TakesWallAndCpuEachForItself) {
  EXPECT_THAT(median(std::vector<Elapsed>{{1, 30}, {2, 20}, {3, 10}}), elapsed(2, 20));
}

TEST(MediansByFrame, TakesTheMiddleOfTheRepeatsOfEachFrame) {
  const std::vector<Elapsed> turns{{1, 2}, {10, 20}, {3, 6}, {90, 20}, {2, 4}, {11, 30}};
  EXPECT_THAT(medians_by_frame(turns, 2), testing::ElementsAre(elapsed(2, 4), elapsed(11, 20)));
}

TEST(MedianRatio, IsThatOfTheFramesNotOfTheMedians) {
  const std::vector<Elapsed> turns{{2, 2}, {30, 10}, {8, 1}};
  const std::vector<Elapsed> unit{{1, 1}, {10, 10}, {1, 1}};
  EXPECT_THAT(median_ratio(turns, unit, 3), elapsed(3, 1));  // of 2, 3 and 8
}

TEST(BestOfRepeats, IsTheMinimumOfEachFrameInWallAndCpu) {
  const std::vector<Elapsed> turns{{5, 9}, {7, 1}, {4, 10}, {8, 2}, {6, 8}};  // of 2 frames
  EXPECT_THAT(best_of_repeats(turns, 2), testing::ElementsAre(elapsed(4, 8), elapsed(7, 1)));
  EXPECT_TRUE(best_of_repeats({}, 3).empty());
}

TEST(MeasureInterleaved, TakesTurnsAndChangesWhoBegins) {
  std::string order;
  const auto contender = [&](char name, double ms) {
    return [&order, name, ms](int turn) -> Result<std::vector<Elapsed>> {
      order += name;
      return std::vector<Elapsed>{{ms + turn, 0}, {0, ms}};
    };
  };
  const auto times = measure_interleaved(std::vector<Contender>{contender('a', 10), contender('b', 20)}, 3);
  ASSERT_TRUE(times);
  EXPECT_EQ(order, "abbaab");
  ASSERT_EQ(times->size(), 2u);
  for (const StageTimes& stages : *times) {
    ASSERT_EQ(stages.size(), 2u);
    for (const auto& turns : stages) EXPECT_EQ(turns.size(), 3u);
  }
  EXPECT_EQ((*times)[0][0][2].wall_ms, 12);
  EXPECT_EQ((*times)[1][1][0].cpu_ms, 20);
}

TEST(MeasureInterleaved, EndsWithTheFirstFailure) {
  int calls = 0;
  const Contender broken = [&](int turn) -> Result<std::vector<Elapsed>> {
    ++calls;
    if (turn == 1) return fail(ErrorCode::kLimit, "too much");
    return std::vector<Elapsed>{{1, 1}};
  };
  const auto times = measure_interleaved(std::vector<Contender>{broken}, 5);
  ASSERT_FALSE(times);
  EXPECT_EQ(times.error().message, "too much");
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace splatlas
