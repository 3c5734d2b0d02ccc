// Blinn-Phong lighting of surfaces and boundary voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Lighting of a surface point: a factor of its colour and a faint white highlight.
struct SurfaceShading {
  float diffuse = 1, highlight = 0;

  [[nodiscard]] float on(float color) const { return std::min(1.0f, color * diffuse + highlight); }
};

/// Share of a ghost's opacity, from the cosine between its normal and the direction to the viewer: faint
/// where it faces the viewer, whole at the rim.
[[nodiscard]] inline float ghost_share(float facing) {
  constexpr float kFacing = 0.06f;
  const float rim = (1 - facing) * (1 - facing);
  return kFacing + (1 - kFacing) * rim;
}

/// Components of all 65536 packed normals, in arrays for SIMD.
struct UnpackedNormals {
  std::vector<float> x, y, z;
  UnpackedNormals();
};
/// Made once. Thread-safe.
[[nodiscard]] const UnpackedNormals& unpacked_normals();

/// One directional light over the viewer's left shoulder, Blinn-Phong (Blinn 1977). Normals need not have
/// unit length. A zero or NaN normal counts as one towards the viewer.
class Lighting {
 public:
  explicit Lighting(const ParallelView& view);

  /// Lighting of a surface. `normal_lps` is the interpolated normal of the visible side; it is not negated
  /// where it points away from the viewer near a silhouette.
  [[nodiscard]] SurfaceShading on_surface(const std::array<float, 3>& normal_lps) const {
    // Without branches, so that loops become vector instructions
    const float length_squared = dot(normal_lps, normal_lps);
    const bool has_length = length_squared > 0;
    const float per_length = 1 / std::sqrt(has_length ? length_squared : 1);
    const float to_light = dot(normal_lps, to_light_) * per_length;
    const float to_half = dot(normal_lps, half_) * per_length;
    const float facing = has_length ? to_light : dot(to_viewer_, to_light_);
    float highlight = has_length && to_half > 0 ? to_half : 0;
    for (int n = 0; n < kHighlightSquarings; ++n) highlight *= highlight;
    return {kAmbient + (1.0f - kAmbient) * std::min(facing > 0 ? facing : 0.0f, 1.0f),
            kHighlight * highlight};
  }
  /// Cosine between a normal, on either side, and the direction to the viewer, 0 to 1; 1 without a length.
  [[nodiscard]] float facing(const std::array<float, 3>& normal_lps) const {
    const float length_squared = dot(normal_lps, normal_lps);
    if (!(length_squared > 0)) return 1;
    return std::min(1.0f, std::abs(dot(normal_lps, to_viewer_)) / std::sqrt(length_squared));
  }
  /// The same as on_surface() for `count` normals, in arrays for SIMD.
  void on_surfaces(std::size_t count, const std::array<const float*, 3>& normals_lps, float* diffuse,
                   float* highlight) const;
  /// Ambient and diffuse factors of a voxel's colour, in [0, 1], for all 65536 packed normals. Voxels are
  /// two-sided: a normal that points away from the viewer is mirrored at the plane of the picture. The factor
  /// is thus continuous. Cost: about 0.1 ms.
  [[nodiscard]] std::vector<float> table() const;

 private:
  static constexpr float kAmbient = 0.15f;
  static constexpr float kHighlight = 0.10f;
  static constexpr int kHighlightSquarings = 5;  // (n . h)^32

  std::array<float, 3> to_viewer_{}, to_light_{}, half_{};
};

/// True if both views have the same lighting, which depends only on the view's orientation.
[[nodiscard]] inline bool have_same_lighting(const ParallelView& a, const ParallelView& b) {
  return a.forward_lps == b.forward_lps && a.up_lps == b.up_lps;
}

}  // namespace splatlas
