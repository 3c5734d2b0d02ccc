// Progress of a build, on a terminal or as JSON.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "preprocess/atlas/build_progress.h"

namespace splatlas {

enum class ProgressMode {
  kPercent,  ///< one line per stage, rewritten in place
  kLines,    ///< one line per stage when it has ended
  kJson,     ///< one JSON object per line
  kNone,
};

/// kPercent on a terminal, otherwise kLines.
[[nodiscard]] ProgressMode automatic_progress(std::FILE* stream);

class ProgressDisplay {
 public:
  ProgressDisplay(ProgressMode mode, std::FILE* stream) : mode_(mode), stream_(stream) {}

  /// Prints at most ten times a second, and always at the end of a stage.
  void show(const BuildProgress& progress);
  /// Ends an unfinished line, so that a message can follow.
  void finish();

 private:
  void show_percent(const BuildProgress& progress);
  void show_json(const BuildProgress& progress);

  ProgressMode mode_;
  std::FILE* stream_;
  bool line_open_ = false;
  std::string stage_;  // the last one shown
  std::chrono::steady_clock::time_point last_shown_;
};

}  // namespace splatlas
