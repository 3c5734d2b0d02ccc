#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "format/tasks/thread_pool.h"

namespace splatlas {
namespace {

TEST(ParallelFor, DoesEveryJobOnce) {
  for (const unsigned threads : {0u, 1u, 2u, 9u}) {
    for (const std::size_t count : {0u, 1u, 3u, 1000u}) {
      std::vector<std::atomic<int>> times(count);
      std::size_t last = 0;
      const std::thread::id caller = std::this_thread::get_id();
      parallel_for(
          count, threads, [&](std::size_t n) { ++times[n]; },
          [&](std::size_t done) {
            EXPECT_TRUE(std::this_thread::get_id() == caller);
            EXPECT_GT(done, last);
            EXPECT_LE(done, count);
            last = done;
          });
      for (const auto& t : times) EXPECT_EQ(t, 1);
      EXPECT_TRUE(threads != 1 || last == count);
    }
  }
}

TEST(ParallelFor, ThrowsWhatAJobThrewAfterAllThreadsHaveEnded) {
  for (const unsigned threads : {1u, 4u}) {
    std::atomic<int> running{0};
    std::string what;
    try {
      parallel_for(
          100, threads,
          [&](std::size_t n) {
            ++running;
            if (n == 7) {
              --running;
              throw std::runtime_error("seven");
            }
            --running;
          },
          [](std::size_t) {});
    } catch (const std::runtime_error& error) {
      what = error.what();
    }
    EXPECT_EQ(what, "seven");
    EXPECT_EQ(running, 0);
  }
}

}  // namespace
}  // namespace splatlas
