// Progress reports and stage timing of a build.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace splatlas {

/// Progress report: sent at the beginning of a stage (fraction 0), at intervals, and once at its end.
struct BuildProgress {
  std::string stage;          ///< "read", "segment", "classify", "surfaces", "write"
  double stage_fraction = 0;  ///< of this stage, 0 to 1
  double total_fraction = 0;  ///< of the whole build, estimated from typical costs of stages
  double stage_seconds = 0;   ///< elapsed in this stage
  double total_seconds = 0;   ///< elapsed in the build
  bool stage_ended = false;
};

using ProgressFunction = std::function<void(const BuildProgress&)>;

/// Measures and reports the stages of a build. Not thread-safe.
class StageClock {
 public:
  /// `listen` may be empty.
  explicit StageClock(ProgressFunction listen) : listen_(std::move(listen)), start_(Clock::now()) {}

  /// Ends the current stage and begins the next. `weight`: its fraction of a typical build, in sum 1.
  void begin(const std::string& stage, double weight) {
    end();
    stage_ = stage;
    weight_ = weight;
    stage_start_ = Clock::now();
    update(0);
  }
  void update(double stage_fraction) { report(stage_fraction, false); }
  void end() {
    if (stage_.empty()) return;
    report(1, true);
    stages_.push_back({stage_, seconds_since(stage_start_)});
    weight_before_ += weight_;
    stage_.clear();
  }

  /// A finished stage.
  struct Stage {
    std::string name;
    double seconds = 0;
  };
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }  ///< finished stages

 private:
  using Clock = std::chrono::steady_clock;
  void report(double stage_fraction, bool ended) const {
    if (!listen_ || stage_.empty()) return;
    listen_({stage_, stage_fraction, std::min(1.0, weight_before_ + weight_ * stage_fraction),
             seconds_since(stage_start_), seconds_since(start_), ended});
  }
  [[nodiscard]] static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  ProgressFunction listen_;
  Clock::time_point start_, stage_start_;
  std::string stage_;
  double weight_ = 0, weight_before_ = 0;
  std::vector<Stage> stages_;
};

}  // namespace splatlas
