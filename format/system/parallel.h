// The same job many times, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace splatlas {

/// Calls job(n) for every n below `count`, in any order, on `threads` threads (0: one per core), of which the
/// caller is one. The caller also calls report(done) after each of its own jobs. The first exception of a job
/// is thrown again by the caller, after all threads have ended.
template <typename Job, typename Report>
void parallel_for(std::size_t count, unsigned threads, Job&& job, Report&& report) {
  std::atomic<std::size_t> next{0}, done{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](auto&& after_each) {
    try {
      for (std::size_t n = next++; n < count; n = next++) {
        job(n);
        after_each(++done);
      }
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> helpers;
  try {
    for (std::size_t t = 1; t < std::min<std::size_t>(threads, count); ++t) {
      helpers.emplace_back([&] { work([](std::size_t) {}); });
    }
  } catch (const std::exception&) {  // std::system_error, std::bad_alloc
    // No more threads to be had: those there are do the work.
  }
  work(report);
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace splatlas
