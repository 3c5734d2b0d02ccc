// Light on surfaces and boundary voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "player/camera.h"

namespace splatlas {

/// The light on a point of a surface: a share of its colour, and a faint white highlight.
struct SurfaceShading {
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
  [[nodiscard]] SurfaceShading on_surface(const std::array<float, 3>& normal_lps) const {
    const float length_squared = dot(normal_lps, normal_lps);
    if (!(length_squared > 0)) return {one_sided(normal_lps), 0};
    const float per_length = 1 / std::sqrt(length_squared);
    const float facing = std::max(0.0f, dot(normal_lps, to_lamp_) * per_length);
    float highlight = std::max(0.0f, dot(normal_lps, half_) * per_length);
    for (int n = 0; n < kHighlightSquarings; ++n) highlight *= highlight;
    return {kAmbient + (1.0f - kAmbient) * std::min(facing, 1.0f), kHighlight * highlight};
  }
  /// diffuse() of every packed normal, for hybrid shading: 65536 entries.
  [[nodiscard]] std::vector<float> table() const;

 private:
  static constexpr float kAmbient = 0.15f;
  static constexpr float kHighlight = 0.10f;
  static constexpr int kHighlightSquarings = 5;  // (n . h)^32

  static float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  [[nodiscard]] float one_sided(const std::array<float, 3>& normal_lps) const;

  std::array<float, 3> to_viewer_{}, to_lamp_{}, half_{};
};

/// Whether both views are lit alike: light changes only with the direction of view.
[[nodiscard]] inline bool have_same_light(const ParallelView& a, const ParallelView& b) {
  return a.forward_lps == b.forward_lps && a.up_lps == b.up_lps;
}

}  // namespace splatlas
