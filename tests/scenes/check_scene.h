// Checks of a random scene's pictures against brute force.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "tests/support/random_scene.h"

namespace splatlas {

struct SceneChecks {
  bool thorough = false;  ///< also the slow checks: antialiasing, visited voxels, every pixel of rays
  double max_rms = 1;     ///< maximum RMS error of rays at high quality, 1/255; see check_scene() for steps
  /// The same over the pixels that picture or reference show, 1/255.
  double max_visible_rms = std::numeric_limits<double>::infinity();
};

struct SceneReport {
  std::vector<std::string> faults;  ///< one line each; empty when all checks pass
  double largest_from_model = 0;    ///< sheets: maximum error of a value against the discrete model
  double rms_from_truth = 0;        ///< rays: RMS error at high quality, 1/255
  bool rays = false;                ///< drawn by ray casting
  bool adaptive = false;            ///< drawn by rays with steps that a tolerance chooses
  bool shows = false;               ///< not empty
  bool refused = false;             ///< field of view too wide for surfaces
  std::size_t pixels = 0;           ///< rays: sampled pixels
  std::size_t compared = 0;         ///< of them, without the ambiguous ones (see RayTruth)
  std::size_t antialiased = 0;      ///< sheets, thorough: pixels that differ from their central sample
};

/// Renders the scene, several times, and compares:
///   - every instruction set, without early ray termination: the scalar reference kernels, to 2e-5;
///   - the numbers of voxels by role, runs and triangles with counts over all voxels and triangles; sheets
///     along every axis, with everything in view: also the number of visited voxels;
///   - values: finite, 0 <= alpha <= 1 and 0 <= colour <= alpha;
///   - pictures of 1, 2 and 8 threads: equal bits;
///   - early ray termination: no value changes by more than the threshold;
///   - depth cue: colours darken by at most its strength, opacities stay;
///   - sheets: the discrete model to float rounding; antialiased pixels: the mean of the model's samples;
///   - rays at high quality, one a pixel: the reference, surfaces in order with the volume, to 1/255 RMS.
///     Where huge grey values turn transfer functions into steps: to 4/255, without the worst pixel in fifty.
///     Antialiasing changes no volume.
[[nodiscard]] SceneReport check_scene(const RandomScene& scene, const SceneChecks& checks);

}  // namespace splatlas
