// Views at switches of the principal axis, where pictures may pop.
#pragma once

#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result.h"
#include "player/camera.h"

namespace splatlas {

/// Two views, 1e-6 rad to either side of a direction midway between two principal axes, off all symmetries.
struct AxisSwitch {
  std::string name;  ///< "x/y 15": the axes, and an angle that identifies the switch
  Camera before, after;
  Axis axis_before = Axis::kX, axis_after = Axis::kX;  ///< principal axes of the player; they differ
};

/// Axis switches of a grid with equal spacings along LPS: between x and y at azimuth 45, elevations 15 and
/// 25; between y and z and between x and z off their symmetry. kFailed if the axis does not switch.
[[nodiscard]] Result<std::vector<AxisSwitch>> axis_switches(const Camera& camera, const Grid& grid,
                                                            const Display& display);

}  // namespace splatlas
