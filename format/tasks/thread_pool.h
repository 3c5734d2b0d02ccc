// Thread pool, and parallel loops.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace splatlas {

/// Runs loops on a fixed number of threads, one of which is the caller. After a loop, threads spin for some
/// microseconds before they sleep: the loops of a frame follow closely, and waking up takes longer.
class ThreadPool {
 public:
  /// 0 stands for one per core; at most 64. Continues with fewer if the system refuses threads.
  explicit ThreadPool(unsigned threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] unsigned threads() const { return static_cast<unsigned>(workers_.size()) + 1; }

  /// Calls body(0) .. body(count - 1), each once, in any order, and returns when all are done. Calls run
  /// concurrently: they must not write to shared data. An exception (out of memory) ends the loop early; the
  /// first one is rethrown. Belongs to the caller's task, if it has one: see TaskControl. Not reentrant; one
  /// caller at a time.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

 private:
  void run_loop(std::size_t count, const std::function<void(std::size_t)>& body);
  void work();
  void take_items(const std::function<void(std::size_t)>& body, std::unique_lock<std::mutex>& lock);

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(std::size_t)>* body_ = nullptr;
  std::exception_ptr failure_;
  std::size_t count_ = 0, next_ = 0;
  std::atomic<std::size_t> running_ = 0, loops_ = 0;  // written with the mutex held, polled without
  bool stop_ = false;
};

/// Calls job(n) for every n below `count`, in any order, on `threads` threads (0: one per core) of a
/// ThreadPool. The caller is one of them, and calls report(done) after each of its jobs. The first exception
/// is rethrown after all threads have ended. Cost: starts the threads; for loops of milliseconds and more.
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
