#include "bench/measure.h"

#include <string>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(Median, IsTheMiddleOne) {
  EXPECT_EQ(median(std::vector<double>{}), 0);
  EXPECT_EQ(median(std::vector<double>{7}), 7);
  EXPECT_EQ(median(std::vector<double>{9, 1, 100}), 9);
  EXPECT_EQ(median(std::vector<double>{9, 1, 100, 3}), 6);
}

TEST(Median, TakesWallAndCpuEachForItself) {
  const Elapsed middle = median(std::vector<Elapsed>{{1, 30}, {2, 20}, {3, 10}});
  EXPECT_EQ(middle.wall_ms, 2);
  EXPECT_EQ(middle.cpu_ms, 20);
}

TEST(MediansByFrame, TakesTheMiddleOfTheRepeatsOfEachFrame) {
  const std::vector<Elapsed> turns{{1, 2}, {10, 20}, {3, 6}, {90, 20}, {2, 4}, {11, 30}};
  const std::vector<Elapsed> medians = medians_by_frame(turns, 2);
  ASSERT_EQ(medians.size(), 2u);
  EXPECT_EQ(medians[0].wall_ms, 2);
  EXPECT_EQ(medians[0].cpu_ms, 4);
  EXPECT_EQ(medians[1].wall_ms, 11);
  EXPECT_EQ(medians[1].cpu_ms, 20);
}

TEST(MedianRatio, IsThatOfTheFramesNotOfTheMedians) {
  const std::vector<Elapsed> turns{{2, 2}, {30, 10}, {8, 1}};
  const std::vector<Elapsed> unit{{1, 1}, {10, 10}, {1, 1}};
  EXPECT_EQ(median_ratio(turns, unit, 3).wall_ms, 3);  // of 2, 3 and 8
  EXPECT_EQ(median_ratio(turns, unit, 3).cpu_ms, 1);
}

TEST(BestOfRepeats, IsTheMinimumOfEachFrameInWallAndCpu) {
  const std::vector<Elapsed> turns{{5, 9}, {7, 1}, {4, 10}, {8, 2}, {6, 8}};  // of 2 frames
  const std::vector<Elapsed> best = best_of_repeats(turns, 2);
  ASSERT_EQ(best.size(), 2u);
  EXPECT_EQ(best[0].wall_ms, 4);
  EXPECT_EQ(best[0].cpu_ms, 8);
  EXPECT_EQ(best[1].wall_ms, 7);
  EXPECT_EQ(best[1].cpu_ms, 1);
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
