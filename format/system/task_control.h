// Cancellation and progress of a task, for all threads that work on it.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <stop_token>
#include <thread>

namespace splatlas {

/// Thrown out of a cancelled task. Like std::bad_alloc it may pass any function that works on a task.
class Cancelled : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// The task of the thread that makes it, until it is destroyed. Loops that a ThreadPool runs for this thread
/// belong to the task, on every thread.
class TaskControl {
 public:
  /// `progress` is called on this thread only, with rising fractions from 0 to 1.
  TaskControl(std::stop_token stop, std::function<void(double)> progress);
  ~TaskControl();
  TaskControl(const TaskControl&) = delete;
  TaskControl& operator=(const TaskControl&) = delete;

  /// The task that this thread works on; null for none.
  [[nodiscard]] static TaskControl* current();

  /// Work up to a fraction `end` of the task begins: the first `loops` loops take equal shares of it. Throws
  /// Cancelled instead when a stop has been requested.
  void begin_stage(double end, std::size_t loops = 1);

  /// All is done.
  void finish();

  // For ThreadPool.

  void begin_loop(std::size_t count);
  /// Runs one item of the loop on any thread. Throws Cancelled instead when a stop has been requested.
  void run_item(const std::function<void(std::size_t)>& body, std::size_t n);

 private:
  friend void check_cancelled();
  void report(double fraction);

  const std::stop_token stop_;
  const std::function<void(double)> progress_;
  const std::thread::id owner_ = std::this_thread::get_id();
  TaskControl* const outer_;  // of the same thread

  // Of the owner's thread.
  double stage_begin_ = 0, stage_end_ = 0, reported_ = 0;
  std::size_t loops_ = 1, loop_ = 0, count_ = 0;

  std::atomic<std::size_t> done_ = 0;  // items of the current loop
};

/// Throws Cancelled when this thread works on a task that is to stop. Cost: some nanoseconds.
void check_cancelled();

}  // namespace splatlas
