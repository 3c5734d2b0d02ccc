// Cancellation, progress and budget of a task, for all threads that work on it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>
#include <utility>

#include "format/result.h"
#include "format/tasks/work_budget.h"

namespace splatlas {

/// Thrown out of a cancelled task. Like std::bad_alloc it may pass any function that works on a task.
class Cancelled : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// Thrown out of a task that exceeds its budget.
class OverBudget : public std::exception {
 public:
  explicit OverBudget(Error error) : error_(std::make_shared<const Error>(std::move(error))) {}
  [[nodiscard]] const char* what() const noexcept override { return error_->message.c_str(); }
  [[nodiscard]] const Error& error() const { return *error_; }

 private:
  std::shared_ptr<const Error> error_;  // exceptions are copied without throwing
};

/// The task of the thread that makes it, until it is destroyed. Loops that a ThreadPool runs for this thread
/// belong to the task, on every thread. Its CPU time counts for the outer task of the thread, too.
class TaskControl {
 public:
  /// `progress` is called on this thread only, with rising fractions from 0 to 1. `budget` may be null and
  /// must outlive the task.
  TaskControl(std::stop_token stop, std::function<void(double)> progress, const WorkBudget* budget = nullptr);
  ~TaskControl();
  TaskControl(const TaskControl&) = delete;
  TaskControl& operator=(const TaskControl&) = delete;

  /// The task that this thread works on; null for none.
  [[nodiscard]] static TaskControl* current();

  /// Begins the work up to a fraction `end` of the task: `loops` equal shares. Throws as check_task().
  void begin_stage(double end, std::size_t loops = 1);

  void finish();

  // For ThreadPool.

  void begin_loop(std::size_t count);
  /// Runs one item of the loop on any thread. Throws as check_task().
  void run_item(const std::function<void(std::size_t)>& body, std::size_t n);

 private:
  friend void check_task();
  friend bool is_task_stopped();
  friend double max_memory();
  friend void check_memory(double bytes);
  void check();
  void charge(double cpu_seconds);
  void report(double fraction);

  const std::stop_token stop_;
  const std::function<void(double)> progress_;
  const WorkBudget* const budget_;
  const std::thread::id owner_ = std::this_thread::get_id();
  TaskControl* const outer_;  // of the same thread

  // Of the owner's thread.
  double stage_begin_ = 0, stage_end_ = 0, reported_ = 0;
  std::size_t loops_ = 1, loop_ = 0, count_ = 0;

  std::atomic<std::size_t> done_ = 0;  // items of the current loop
  std::atomic<double> cpu_seconds_ = 0;
};

/// Throws Cancelled when this thread works on a task that is to stop, and OverBudget when the task has used
/// up its CPU time. Every loop that can take milliseconds calls it. Cost: some ten nanoseconds.
void check_task();

/// True when this thread works on a task that is to stop: for callbacks that must not throw, and for work
/// that no budget limits.
[[nodiscard]] bool is_task_stopped();

/// Calls check_task() every 2^14th time: for loops with steps of nanoseconds.
class TaskPace {
 public:
  void step() {
    if ((++steps_ & 0x3fff) == 0) check_task();
  }

 private:
  std::uint32_t steps_ = 0;
};

/// Bytes of memory that the task of this thread may hold; infinite without a task or its limit.
[[nodiscard]] double max_memory();

/// Throws OverBudget when this thread works on a task that may not hold `bytes` of memory. Call it ahead of
/// allocations that a file of few bytes can make large.
void check_memory(double bytes);

}  // namespace splatlas
