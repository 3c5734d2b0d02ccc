#include "format/tasks/thread_pool.h"

#include <utility>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Spins, with the mutex released, until is_done() or some 30 microseconds have passed.
template <typename IsDone>
void wait_briefly(std::unique_lock<std::mutex>& lock, const IsDone& is_done) {
  constexpr int kTries = 60;
  lock.unlock();
  for (int n = 0; n < kTries && !is_done(); ++n) std::this_thread::yield();
  lock.lock();
}

}  // namespace

ThreadPool::ThreadPool(unsigned threads) {
  constexpr unsigned kMaxThreads = 64;
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  try {
    for (unsigned n = 1; n < std::min(threads, kMaxThreads); ++n) workers_.emplace_back([this] { work(); });
  } catch (const std::exception&) {  // std::system_error, std::bad_alloc
    // Continue with fewer threads.
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  TaskControl* const task = TaskControl::current();
  if (task == nullptr) return run_loop(count, body);
  task->begin_loop(count);
  run_loop(count, [task, &body](std::size_t n) { task->run_item(body, n); });
}

void ThreadPool::run_loop(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  if (workers_.empty() || count == 1) {
    for (std::size_t n = 0; n < count; ++n) body(n);
    return;
  }
  std::unique_lock lock(mutex_);
  body_ = &body;
  count_ = count;
  next_ = 0;
  ++loops_;
  start_.notify_all();
  take_items(body, lock);
  if (running_ != 0) wait_briefly(lock, [this] { return running_ == 0; });
  done_.wait(lock, [this] { return running_ == 0; });
  body_ = nullptr;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wait_briefly(lock, [this, seen = loops_.load()] { return loops_ != seen; });
    start_.wait(lock, [this] { return stop_ || (body_ != nullptr && next_ < count_); });
    if (stop_) return;
    take_items(*body_, lock);
  }
}

void ThreadPool::take_items(const std::function<void(std::size_t)>& body,
                            std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const std::size_t item = next_++;
    ++running_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      body(item);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      if (!failure_) failure_ = failure;
      next_ = count_;
    }
    if (--running_ == 0 && next_ >= count_) done_.notify_all();
  }
}

}  // namespace splatlas
