// Where the principal axis switches: views between which a picture may pop.
#pragma once

#include <string>
#include <vector>

#include "format/grid.h"
#include "format/result.h"
#include "player/camera.h"

namespace splatlas {

/// Two views, a millionth of a radian to either side of a direction that passes as many slices along one axis
/// as along another, and off all symmetries.
struct AxisSwitch {
  std::string name;  ///< "x/y 15": the axes, and an angle that tells switches apart
  Camera before, after;
  Axis axis_before = Axis::kX, axis_after = Axis::kX;  ///< ours; they differ
};

/// Of a grid with equal spacings along LPS: between x and y as in reference measurements at azimuth 45,
/// elevations 15 and 25; between y and z, and x and z, off their symmetry as well. kFailed where the axis
/// does not switch.
[[nodiscard]] Result<std::vector<AxisSwitch>> axis_switches(const Camera& camera, const Grid& grid,
                                                            const Display& display);

}  // namespace splatlas
