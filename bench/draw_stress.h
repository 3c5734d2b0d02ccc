// Drawing inputs that break renderers, and looking at every pixel.
#pragma once

#include <cstdint>

#include "bench/stress_inputs.h"
#include "player/picture.h"

namespace splatlas {

/// What came out of drawing them.
struct StressOutcome {
  std::uint64_t pictures = 0, pixels = 0;
  std::uint64_t refused = 0;     ///< pictures: with an error, as views that are not finite must be
  std::uint64_t nan_pixels = 0;  ///< with a channel that is no finite number
  std::uint64_t unphysical = 0;  ///< pixels that are not 0 <= colour <= alpha <= 1 to 1e-5
  StressOutcome& operator+=(const StressOutcome& other);
};

/// Adds what a picture shows.
void inspect(const Picture& picture, StressOutcome& outcome);

/// Draws an input all ways: every selection, camera and option, parallel and in perspective, classified
/// before and after interpolation, at every quality.
[[nodiscard]] StressOutcome draw_stress(const StressInput& input);

/// Random scenes of the tests, drawn as they are and in perspective.
[[nodiscard]] StressOutcome draw_random_scenes(std::uint32_t count);

}  // namespace splatlas
