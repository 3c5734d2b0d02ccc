#include "format/system/task_control.h"

#include <algorithm>
#include <utility>

namespace splatlas {
namespace {

/// Minimum step of reported progress.
constexpr double kMinProgress = 1.0 / 256;

thread_local TaskControl* current_task = nullptr;

/// Makes a task that of this thread for a while.
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

TaskControl::TaskControl(std::stop_token stop, std::function<void(double)> progress)
    : stop_(std::move(stop)), progress_(std::move(progress)), outer_(std::exchange(current_task, this)) {}

TaskControl::~TaskControl() {
  current_task = outer_;
}

TaskControl* TaskControl::current() {
  return current_task;
}

void TaskControl::begin_stage(double end, std::size_t loops) {
  if (stop_.stop_requested()) throw Cancelled();
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
  if (stop_.stop_requested()) throw Cancelled();
  const TaskScope scope(this);
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

void check_cancelled() {
  if (current_task != nullptr && current_task->stop_.stop_requested()) throw Cancelled();
}

}  // namespace splatlas
