// Where a build is.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace splatlas {

/// Sent when a stage begins (fraction 0), now and then while it runs, and once when it has ended.
struct BuildProgress {
  std::string stage;          ///< "read", "segment", "classify", "surfaces", "write"
  double stage_fraction = 0;  ///< of this stage, 0..1
  double total_fraction = 0;  ///< of the whole build, by the usual cost of stages
  double stage_seconds = 0;   ///< spent on this stage so far
  double total_seconds = 0;
  bool stage_ended = false;
};

using ProgressFunction = std::function<void(const BuildProgress&)>;

/// Keeps the time of stages and reports them. For one thread.
class StageClock {
 public:
  /// `listen` may be empty.
  explicit StageClock(ProgressFunction listen) : listen_(std::move(listen)), start_(Clock::now()) {}

  /// Ends the stage before. `weight` is this stage's share of a usual build; all shares should add up to 1.
  void begin(const std::string& stage, double weight);
  void update(double stage_fraction);
  void end();

  /// What ended, and how long it took.
  struct Stage {
    std::string name;
    double seconds = 0;
  };
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }  ///< those that ended

 private:
  using Clock = std::chrono::steady_clock;
  void report(double stage_fraction, bool ended) const;
  [[nodiscard]] static double seconds_since(Clock::time_point start);

  ProgressFunction listen_;
  Clock::time_point start_, stage_start_;
  std::string stage_;
  double weight_ = 0, weight_before_ = 0;
  std::vector<Stage> stages_;
};

}  // namespace splatlas
