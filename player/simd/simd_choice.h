// Which instruction set the kernels take.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <hwy/highway.h>
#include <hwy/targets.h>

namespace splatlas {

/// SPLATLAS_SIMD=scalar in the environment.
inline bool scalar_is_forced() {
  const char* forced = std::getenv("SPLATLAS_SIMD");
  return forced != nullptr && std::strcmp(forced, "scalar") == 0;
}

/// The name of the best one that there are kernels for and that this machine runs.
inline const char* best_target() {
  const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(supported & -supported);  // the best is the lowest bit
}

}  // namespace splatlas
