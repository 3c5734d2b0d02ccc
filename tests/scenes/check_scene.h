// Everything that must hold for a picture of any scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/random_scene.h"

namespace splatlas {

/// What was looked at, and what is wrong.
struct SceneReport {
  std::vector<std::string> faults;  ///< one line each; none: all is well
  double largest_from_model = 0;    ///< of sheets: any value less the model's in double precision
  double rms_from_truth = 0;        ///< of rays at high quality, 1/255
  bool rays = false;                ///< drawn by rays
  bool shows = false;               ///< any pixel shows anything
  std::uint32_t pixels = 0;         ///< of rays: those asked what the truth is
  std::uint32_t compared = 0;       ///< of them, where rounding does not decide what is seen
  bool refused = false;             ///< a field of view that surfaces cannot be drawn in
};

/// Renders the scene, several times, and compares:
///   - numbers of voxels by role, runs, and triangles with counts over all voxels and triangles;
///   - values are numbers, 0 <= alpha <= 1 and 0 <= colour <= alpha;
///   - 1, 2 and 8 threads give equal bits;
///   - early termination changes no value by more than its floor, and adds no light to volumes alone;
///   - a depth cue darkens colours by no more than its strength, and nothing else;
///   - sheets equal the discrete model to float rounding, and antialiased pixels the mean of their samples;
///   - rays at high quality show the truth, surfaces in order with the volume: to 1/255 RMS, 4/255 but for
///     one pixel in fifty where grey values are beyond all measure.
/// `thorough`: also what takes long, the mean of samples.
[[nodiscard]] SceneReport check_scene(const RandomScene& scene, bool thorough);

}  // namespace splatlas
