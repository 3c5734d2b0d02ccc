// The truth of a scene that is drawn by rays.
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
  /// Keeps a reference to `scene`. Classified after interpolation, volumes are unlit.
  RayTruth(const RandomScene& scene, bool hybrid_shading);

  /// RGBA of a pixel; nothing where a hundredth of a pixel changes which surfaces are seen, or their order.
  [[nodiscard]] std::optional<std::array<double, 4>> at(int column, int row) const;

 private:
  [[nodiscard]] reference::Ray ray_through(double x, double y) const;
  [[nodiscard]] reference::RayRadiance volume(const reference::Ray& ray, double from_mm, double to_mm) const;

  const RandomScene& scene_;
  View view_;
  Grid grid_;
  double nearest_mm_ = 0;  // of what is seen of surfaces
  reference::RaySurfaces surfaces_;
  std::optional<reference::OpticalField> field_;
  std::optional<reference::InterpolatedGreys> greys_;
};

}  // namespace splatlas
