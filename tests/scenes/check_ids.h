// Checks of a random scene's id image against brute force.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/random_scene.h"

namespace splatlas {

struct IdReport {
  std::vector<std::string> faults;  ///< one line each; empty when all checks pass
  std::size_t pixels = 0;           ///< with a structure
  std::size_t mixed = 0;            ///< of them, with two shares of similar size
};

/// Renders the scene with ids and depths, several times, and compares:
///   - pictures with and without them: equal bits;
///   - ids and depths of 1, 2 and 8 threads: equal;
///   - pixels below the threshold of opacity: no number and no depth;
///   - at high quality, one ray a pixel: each pixel's share along the exact ray is at least the largest one
///     less 1e-3.
[[nodiscard]] IdReport check_ids(const RandomScene& scene);

}  // namespace splatlas
