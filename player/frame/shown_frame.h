// Geometry of a finished frame: its view, its slices and the depths of its fragments.
#pragma once

#include <cstddef>
#include <optional>

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Enough to pick structures in the frame, and to tell depths.
struct ShownFrame {
  View view;
  std::optional<Axis> sheets;  ///< slices are normal to it; none: a frame of rays
  std::size_t depth_axis = 2;  ///< fragments' depths are `depth_sign` times positions along it, in voxels
  double depth_sign = 1;
};

}  // namespace splatlas
