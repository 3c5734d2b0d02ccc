// Rendering of stress inputs, with a check of every pixel.
#pragma once

#include <cstdint>

#include "bench/experiments/stress_inputs.h"
#include "player/picture.h"

namespace splatlas {

/// Outcome of stress inputs.
struct StressOutcome {
  std::uint64_t pictures = 0, pixels = 0;
  std::uint64_t refused = 0;     ///< pictures refused with an error, as for views that are not finite
  std::uint64_t nan_pixels = 0;  ///< pixels with a channel that is not finite
  std::uint64_t unphysical = 0;  ///< pixels that violate 0 <= colour <= alpha <= 1 by more than 1e-5
  StressOutcome& operator+=(const StressOutcome& other);
};

/// Adds the counts of a picture.
void inspect(const Picture& picture, StressOutcome& outcome);

/// Draws every selection, camera and option of an input in both projections and classifications, at every
/// quality.
[[nodiscard]] StressOutcome draw_stress(const StressInput& input);

/// Draws the random scenes of the tests in both projections and classifications.
[[nodiscard]] StressOutcome draw_random_scenes(std::uint32_t count);

}  // namespace splatlas
