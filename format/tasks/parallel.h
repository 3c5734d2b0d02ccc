// Parallel loop with progress.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>

#include "format/tasks/thread_pool.h"

namespace splatlas {

/// Calls job(n) for every n below `count`, in any order, on `threads` threads (0: one per core) of a
/// ThreadPool. The caller is one of them, and also calls report(done) after each of its own jobs. The first
/// exception of a job is rethrown after all threads have ended. Cost: starts the threads; for loops of
/// milliseconds and more.
template <typename Job, typename Report>
void parallel_for(std::size_t count, unsigned threads, Job&& job, Report&& report) {
  if (count == 0) return;
  std::atomic<std::size_t> done{0};
  const std::thread::id caller = std::this_thread::get_id();
  const auto run = [&](std::size_t n) {
    job(n);
    const std::size_t now_done = ++done;
    if (std::this_thread::get_id() == caller) report(now_done);
  };
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  ThreadPool(static_cast<unsigned>(std::min<std::size_t>(threads, count))).for_each(count, std::ref(run));
}
/// The same without progress.
template <typename Job>
void parallel_for(std::size_t count, unsigned threads, Job&& job) {
  parallel_for(count, threads, job, [](std::size_t) {});
}

}  // namespace splatlas
