// Light on surfaces and boundary voxels.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "player/camera.h"

namespace splatlas {

/// The light on a point of a surface: a share of its colour, and a faint white highlight.
struct SurfaceLight {
  float diffuse = 1, highlight = 0;

  [[nodiscard]] float on(float color) const { return std::min(1.0f, color * diffuse + highlight); }
};

/// A lamp over the viewer's left shoulder. Normals need not be of unit length; a zero normal (or one that is
/// not a number) is lit as if it faced the viewer.
class Lighting {
 public:
  explicit Lighting(const ParallelView& view);

  /// Diffuse share of a structure's colour, in [0, 1], for voxels, which have no back: a normal that points
  /// away from the viewer is turned round.
  [[nodiscard]] float diffuse(const std::array<float, 3>& normal_lps) const;
  /// For surfaces. `normal_lps` is that of the side which is seen; where interpolation has turned it a little
  /// away from the viewer, it stays so.
  [[nodiscard]] SurfaceLight on_surface(const std::array<float, 3>& normal_lps) const;
  /// diffuse() of every packed normal, for hybrid shading: 65536 entries.
  [[nodiscard]] std::vector<float> table() const;

 private:
  [[nodiscard]] float one_sided(const std::array<float, 3>& normal_lps) const;

  std::array<float, 3> to_viewer_{}, to_lamp_{}, half_{};
};

}  // namespace splatlas
