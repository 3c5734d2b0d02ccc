// Geometry of a finished frame: view, slices and fragment depths.
#pragma once

#include <cstddef>
#include <optional>

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Geometry for picking and depth maps.
struct ShownFrame {
  View view;
  std::optional<Axis> sheets;  ///< normal of the slices; none: ray casting
  std::size_t depth_axis = 2;  ///< fragment depth: `depth_sign` * position along this axis, in voxels
  double depth_sign = 1;
};

}  // namespace splatlas
