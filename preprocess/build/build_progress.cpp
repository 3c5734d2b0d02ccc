#include "preprocess/build/build_progress.h"

#include <algorithm>

namespace splatlas {

double StageClock::seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void StageClock::begin(const std::string& stage, double weight) {
  end();
  stage_ = stage;
  weight_ = weight;
  stage_start_ = Clock::now();
  update(0);
}

void StageClock::update(double stage_fraction) {
  report(stage_fraction, false);
}

void StageClock::report(double stage_fraction, bool ended) const {
  if (!listen_ || stage_.empty()) return;
  listen_({stage_, stage_fraction, std::min(1.0, weight_before_ + weight_ * stage_fraction),
           seconds_since(stage_start_), seconds_since(start_), ended});
}

void StageClock::end() {
  if (stage_.empty()) return;
  report(1, true);
  stages_.push_back({stage_, seconds_since(stage_start_)});
  weight_before_ += weight_;
  stage_.clear();
}

}  // namespace splatlas
