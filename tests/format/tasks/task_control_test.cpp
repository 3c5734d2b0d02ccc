#include "format/tasks/task_control.h"

#include <gmock/gmock.h>

#include "format/tasks/thread_pool.h"

namespace splatlas {
namespace {

TEST(TaskControl, LoopsOfATaskRunNoItemAfterAStop) {
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    std::stop_source stop;
    TaskControl task(stop.get_token(), {});
    std::atomic<int> begun_after = 0;
    EXPECT_THROW(pool.for_each(10000,
                               [&](std::size_t n) {
                                 if (stop.stop_requested()) ++begun_after;
                                 if (n == 20) stop.request_stop();
                               }),
                 Cancelled);
    EXPECT_LT(begun_after, static_cast<int>(threads));  // those that were about to begin
    EXPECT_THROW(pool.for_each(1, [](std::size_t) {}), Cancelled);
    EXPECT_THROW(task.begin_stage(1), Cancelled);
  }
}

TEST(TaskControl, IsSeenInsideItemsOnEveryThread) {
  ThreadPool pool(4);
  std::stop_source stop;
  TaskControl task(stop.get_token(), {});
  std::atomic<int> threw = 0;
  EXPECT_THROW(pool.for_each(4,
                             [&](std::size_t) {
                               EXPECT_EQ(TaskControl::current(), &task);
                               stop.request_stop();
                               try {
                                 check_task();
                               } catch (const Cancelled&) {
                                 ++threw;
                                 throw;
                               }
                             }),
               Cancelled);
  EXPECT_GT(threw, 0);
}

TEST(TaskControl, EndsWithItsScope) {
  EXPECT_EQ(TaskControl::current(), nullptr);
  std::stop_source stop;
  stop.request_stop();
  {
    const TaskControl outer(stop.get_token(), {});
    EXPECT_THROW(check_task(), Cancelled);
    const TaskControl inner({}, {});
    EXPECT_THROW(check_task(), Cancelled);  // with the outer one
  }
  EXPECT_EQ(TaskControl::current(), nullptr);
  EXPECT_NO_THROW(check_task());
  ThreadPool pool(3);
  int items = 0;
  pool.for_each(1, [&](std::size_t) { ++items; });
  EXPECT_EQ(items, 1);
}

/// A budget of less than the interval between two looks at the clock.
TEST(TaskControl, EndsBeyondItsCpuTimeOnEveryThread) {
  for (const unsigned threads : {1u, 3u}) {
    ThreadPool pool(threads);
    const WorkBudget budget("a.atlas", 100, 1e-4, 1000);
    TaskControl outer({}, {}, &budget);
    const TaskControl inner({}, {});
    std::atomic<int> ended = 0;
    const auto work = [&](std::size_t) {
      try {
        while (true) check_task();
      } catch (const OverBudget& over) {
        EXPECT_EQ(over.error().message, budget.time_exceeded().message);
        ++ended;
        throw;
      }
    };
    EXPECT_THROW(pool.for_each(threads, work), OverBudget);
    EXPECT_GT(ended, 0);
    EXPECT_THROW(
        {
          while (true) check_task();
        },
        OverBudget);
  }
}

TEST(TaskControl, HoldsNoMoreMemoryThanItsBudget) {
  const WorkBudget budget("a.atlas", 100, 1, 1000);
  EXPECT_NO_THROW(check_memory(1e30));
  const TaskControl task({}, {}, &budget);
  EXPECT_NO_THROW(check_memory(500));
  EXPECT_THROW(check_memory(501), OverBudget);
}

TEST(TaskControl, ProgressRisesToOneOnTheCallersThread) {
  const std::thread::id caller = std::this_thread::get_id();
  for (const unsigned threads : {1u, 3u}) {
    ThreadPool pool(threads);
    std::vector<double> reports;
    TaskControl task({}, [&](double fraction) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      reports.push_back(fraction);
    });
    task.begin_stage(0.5, 2);
    for (int loop = 0; loop < 4; ++loop) pool.for_each(100, [](std::size_t) {});  // two more than told
    task.begin_stage(1);
    pool.for_each(100, [](std::size_t) {});
    task.finish();
    EXPECT_EQ(reports.back(), 1);
    EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end(), std::less_equal<>()));
    if (threads == 1) {
      EXPECT_THAT(reports, testing::IsSupersetOf({0.25, 0.5}));
    }
  }
}

}  // namespace
}  // namespace splatlas
