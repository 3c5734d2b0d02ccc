#include "format/tasks/task_control.h"

#include <algorithm>
#include <limits>

#include <time.h>  // clock_gettime is POSIX's, not <ctime>'s

namespace splatlas {
namespace {

/// Minimum step of reported progress.
constexpr double kMinProgress = 1.0 / 256;

thread_local TaskControl* current_task = nullptr;
/// CPU time of this thread that tasks have been charged for, in seconds, and the wall clock then.
thread_local double charged_until = 0;
thread_local double charged_at = 0;

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Wall clock of the last tick: a fifth of the cost of the exact one, which loops would notice.
double tick_seconds() {
  return seconds_of(CLOCK_MONOTONIC_COARSE);
}

/// CPU time since the last call.
double uncharged_seconds() {
  charged_at = tick_seconds();
  const double now = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  return now - std::exchange(charged_until, now);
}

/// Makes a task that of this thread for a while. Time of less than an interval may be charged later.
class TaskScope {
 public:
  explicit TaskScope(TaskControl* task) : before_(std::exchange(current_task, task)) {}
  ~TaskScope() { current_task = before_; }
  TaskScope(const TaskScope&) = delete;
  TaskScope& operator=(const TaskScope&) = delete;

 private:
  TaskControl* before_;
};

}  // namespace

TaskControl::TaskControl(std::stop_token stop, std::function<void(double)> progress, const WorkBudget* budget)
    : stop_(std::move(stop)), progress_(std::move(progress)), budget_(budget), outer_(current_task) {
  const double before = uncharged_seconds();
  if (outer_ != nullptr) outer_->charge(before);
  current_task = this;
}

TaskControl::~TaskControl() {
  charge(uncharged_seconds());
  current_task = outer_;
}

TaskControl* TaskControl::current() {
  return current_task;
}

void TaskControl::begin_stage(double end, std::size_t loops) {
  check();
  report(stage_end_);
  stage_begin_ = stage_end_;
  stage_end_ = end;
  loops_ = loops;
  loop_ = 0;
}

void TaskControl::finish() {
  if (progress_ && reported_ < 1) progress_(1);
}

void TaskControl::begin_loop(std::size_t count) {
  ++loop_;
  count_ = count;
  done_ = 0;
}

void TaskControl::run_item(const std::function<void(std::size_t)>& body, std::size_t n) {
  const TaskScope scope(this);
  check();
  body(n);
  const std::size_t done = ++done_;
  if (loop_ > loops_ || std::this_thread::get_id() != owner_) return;
  const double loops =
      static_cast<double>(loop_ - 1) + static_cast<double>(done) / static_cast<double>(count_);
  report(stage_begin_ + (stage_end_ - stage_begin_) * std::min(loops / static_cast<double>(loops_), 1.0));
}

void TaskControl::report(double fraction) {
  if (!progress_ || fraction < reported_ + kMinProgress) return;
  reported_ = fraction;
  progress_(fraction);
}

void TaskControl::charge(double cpu_seconds) {
  for (TaskControl* task = this; task != nullptr; task = task->outer_) task->cpu_seconds_ += cpu_seconds;
}

void TaskControl::check() {
  // The clock of a thread takes a system call. No thread uses more CPU time than passes on the wall.
  constexpr double kInterval = 0.005;
  if (is_task_stopped()) throw Cancelled();
  if (tick_seconds() - charged_at < kInterval) return;
  charge(uncharged_seconds());
  for (const TaskControl* task = this; task != nullptr; task = task->outer_) {
    if (task->budget_ != nullptr && task->cpu_seconds_ > task->budget_->cpu_seconds())
      throw OverBudget(task->budget_->time_exceeded());
  }
}

void check_task() {
  if (current_task != nullptr) current_task->check();
}

bool is_task_stopped() {
  const TaskControl* task = current_task;
  while (task != nullptr && !task->stop_.stop_requested()) task = task->outer_;
  return task != nullptr;
}

double max_memory() {
  double bytes = std::numeric_limits<double>::infinity();
  for (const TaskControl* task = current_task; task != nullptr; task = task->outer_) {
    if (task->budget_ != nullptr) bytes = std::min(bytes, task->budget_->memory_bytes());
  }
  return bytes;
}

void check_memory(double bytes) {
  for (const TaskControl* task = current_task; task != nullptr; task = task->outer_) {
    if (task->budget_ != nullptr && bytes > task->budget_->memory_bytes())
      throw OverBudget(task->budget_->memory_exceeded(bytes));
  }
}

}  // namespace splatlas
