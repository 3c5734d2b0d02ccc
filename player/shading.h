// Light on surfaces and boundary voxels.
#pragma once

#include <array>
#include <vector>

#include "player/camera.h"

namespace splatlas {

/// A lamp over the viewer's left shoulder. Normals need not be of unit length; a zero normal (or one that is
/// not a number) is lit as if it faced the viewer.
class Lighting {
 public:
  explicit Lighting(const ParallelView& view);

  /// Diffuse share of a structure's colour, in [0, 1], for voxels, which have no back: a normal that points
  /// away from the viewer is turned round.
  [[nodiscard]] float diffuse(const std::array<float, 3>& normal_lps) const;
  /// For surfaces: diffuse share times `color`, and a faint white highlight. `normal_lps` is that of the side
  /// which is seen; where interpolation has turned it a little away from the viewer, it stays so.
  [[nodiscard]] std::array<float, 3> shade(const std::array<float, 3>& color,
                                           const std::array<float, 3>& normal_lps) const;
  /// diffuse() of every packed normal, for hybrid shading: 65536 entries.
  [[nodiscard]] std::vector<float> table() const;

 private:
  [[nodiscard]] float one_sided(const std::array<float, 3>& normal_lps) const;

  std::array<float, 3> to_viewer_{}, to_lamp_{}, half_{};
};

}  // namespace splatlas
