// Stopwatch of wall-clock and CPU time.
#pragma once

#include <utility>

#include <time.h>  // clock_gettime is POSIX's, not <ctime>'s

#include "player/render_options.h"

namespace splatlas {

/// Starts at construction. Cost: two system calls a lap, below a microsecond.
class Stopwatch {
 public:
  /// Time since the last call, or since construction.
  Elapsed lap() {
    const Elapsed now{milliseconds(CLOCK_MONOTONIC), milliseconds(CLOCK_PROCESS_CPUTIME_ID)};
    const Elapsed before = std::exchange(start_, now);
    return {now.wall_ms - before.wall_ms, now.cpu_ms - before.cpu_ms};
  }

 private:
  static double milliseconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  }

  Elapsed start_{milliseconds(CLOCK_MONOTONIC), milliseconds(CLOCK_PROCESS_CPUTIME_ID)};
};

}  // namespace splatlas
