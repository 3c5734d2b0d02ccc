#include "format/tasks/thread_pool.h"

#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(ThreadPool, CallsEachNumberOnce) {
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.threads(), threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u}) {
      std::vector<std::atomic<int>> calls(count);
      pool.for_each(count, [&](std::size_t n) { ++calls.at(n); });
      for (const auto& n : calls) ASSERT_EQ(n, 1);
    }
  }
}

/// A worker that wakes late must not join a finished loop.
TEST(ThreadPool, RunsManyShortLoops) {
  ThreadPool pool(8);
  std::size_t sum = 0;
  for (int loop = 0; loop < 3000; ++loop) {
    std::array<std::size_t, 5> squares{};
    pool.for_each(squares.size(), [&](std::size_t n) { squares[n] = n * n; });
    for (const std::size_t square : squares) sum += square;
  }
  EXPECT_EQ(sum, 3000u * 30u);
}

TEST(ThreadPool, UsesItsThreadsAndTheCaller) {
  ThreadPool pool(4);
  std::mutex mutex;
  std::condition_variable all_here;
  std::set<std::thread::id> ids;
  // Waits until four threads have arrived.
  pool.for_each(4, [&](std::size_t) {
    std::unique_lock lock(mutex);
    ids.insert(std::this_thread::get_id());
    all_here.notify_all();
    all_here.wait(lock, [&] { return ids.size() == 4; });
  });
  EXPECT_TRUE(ids.contains(std::this_thread::get_id()));
}

TEST(ThreadPool, TakesOneThreadPerCoreByDefaultAndNeverTooMany) {
  EXPECT_EQ(ThreadPool(0).threads(), std::min(64u, std::max(1u, std::thread::hardware_concurrency())));
  EXPECT_EQ(ThreadPool(1000).threads(), 64u);
}

TEST(ThreadPool, AnExceptionReachesTheCallerAndThePoolStaysUsable) {
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    for (int trial = 0; trial < 50; ++trial) {
      EXPECT_THROW(pool.for_each(20,
                                 [](std::size_t n) {
                                   if (n == 7) throw std::runtime_error("seven");
                                 }),
                   std::runtime_error);
      std::atomic<int> calls = 0;
      pool.for_each(20, [&](std::size_t) { ++calls; });
      EXPECT_EQ(calls, 20);
    }
  }
}

}  // namespace
}  // namespace splatlas
