// Reference ray caster for random scenes, in double precision.
#pragma once

#include <array>
#include <optional>

#include "tests/reference/interpolated_greys.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/ray_surfaces.h"
#include "tests/support/random_scene.h"

namespace splatlas {

class RayTruth {
 public:
  /// Keeps a reference to `scene`. Post-classified volumes are unlit.
  RayTruth(const RandomScene& scene, bool hybrid_shading);

  /// RGBA of a pixel. Nothing for an ambiguous one: a ray 0.01 pixels beside it crosses other surfaces, or
  /// the same in another order.
  [[nodiscard]] std::optional<std::array<double, 4>> at(int column, int row) const;

 private:
  [[nodiscard]] reference::Ray ray_through(double x, double y) const;
  [[nodiscard]] reference::RayRadiance volume(const reference::Ray& ray, double from_mm, double to_mm) const;

  const RandomScene& scene_;
  View view_;
  Grid grid_;
  double nearest_mm_ = 0;  // near plane of surfaces
  reference::RaySurfaces surfaces_;
  std::optional<reference::OpticalField> field_;
  std::optional<reference::InterpolatedGreys> greys_;
};

}  // namespace splatlas
