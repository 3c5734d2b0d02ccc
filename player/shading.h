// Light on surfaces and boundary voxels.
#pragma once

#include <array>
#include <vector>

#include "player/camera.h"

namespace splatlas {

/// A lamp over the viewer's left shoulder, two-sided: a normal that points away from the viewer is turned
/// round.
class Lighting {
 public:
  explicit Lighting(const ParallelView& view);

  /// Diffuse share of a structure's colour, in [0, 1]. `normal_lps` need not be of unit length; a zero normal
  /// (or one that is not a number) is lit as if it faced the viewer.
  [[nodiscard]] float diffuse(const std::array<float, 3>& normal_lps) const;
  /// Diffuse times `color`, and a faint white highlight.
  [[nodiscard]] std::array<float, 3> shade(const std::array<float, 3>& color,
                                           const std::array<float, 3>& normal_lps) const;
  /// diffuse() of every packed normal, for hybrid shading: 65536 entries.
  [[nodiscard]] std::vector<float> table() const;

 private:
  std::array<float, 3> to_viewer_{}, to_lamp_{}, half_{};
};

}  // namespace splatlas
