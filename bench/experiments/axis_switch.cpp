#include "bench/experiments/axis_switch.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "player/render/view/shear.h"

namespace splatlas {
namespace {

constexpr double kOffDeg = 1e-6 * 180 / std::numbers::pi;

/// A view direction shared by two axes, and the angle that crosses it.
struct Direction {
  const char* axes;
  double azimuth_deg, elevation_deg;
  bool turns_azimuth;
};

/// View directions have components (sin az cos el, cos az cos el, sin el), up to signs.
std::vector<Direction> shared_directions() {
  const auto elevation_of = [](double along) { return std::atan(along) * 180 / std::numbers::pi; };
  constexpr double kTurnDeg = 20;
  const double along_y = std::cos(kTurnDeg * std::numbers::pi / 180);
  return {{"x/y", 45, 15, true},
          {"x/y", 45, 25, true},
          {"y/z", kTurnDeg, elevation_of(along_y), false},
          {"x/z", 90 - kTurnDeg, elevation_of(along_y), false}};
}

}  // namespace

Result<std::vector<AxisSwitch>> axis_switches(const Camera& camera, const Grid& grid,
                                              const Display& display) {
  std::vector<AxisSwitch> switches;
  for (const Direction& direction : shared_directions()) {
    AxisSwitch across{fmt::format("{} {:.0f}", direction.axes, direction.elevation_deg), camera, camera};
    for (Camera* side : {&across.before, &across.after}) {
      const double off = side == &across.before ? -kOffDeg : kOffDeg;
      side->azimuth_deg = direction.azimuth_deg + (direction.turns_azimuth ? off : 0);
      side->elevation_deg = direction.elevation_deg + (direction.turns_azimuth ? 0 : off);
      SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(*side, {64, 64}, display));
      (side == &across.before ? across.axis_before : across.axis_after) = factorise(view, grid).principal;
    }
    if (across.axis_before == across.axis_after) {
      return fail(
          ErrorCode::kFailed,
          fmt::format("the principal axis does not switch at azimuth {}, elevation {}: voxels must be "
                      "cubes along LPS",
                      direction.azimuth_deg, direction.elevation_deg));
    }
    switches.push_back(std::move(across));
  }
  return switches;
}

}  // namespace splatlas
