// Extents of points in a view direction, and the camera whose picture they fill.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Linear functions on points: the four planes of a view's frustum, the depth and the negative depth.
struct FitPlanes {
  static constexpr std::size_t kCount = 6;
  std::array<Vec3, kCount> gradient{};
  std::array<double, kCount> offset{};

  [[nodiscard]] double at(std::size_t n, const Vec3& p) const {
    return gradient[n][0] * p[0] + gradient[n][1] * p[1] + gradient[n][2] * p[2] + offset[n];
  }
};

/// Maxima of the functions over a set of points. They do not depend on the order of insertion.
class FitExtents {
 public:
  FitExtents() { max_.fill(-std::numeric_limits<double>::infinity()); }

  [[nodiscard]] bool empty() const { return max_[0] == -std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double max(std::size_t n) const { return max_[n]; }

  void include(const FitPlanes& planes, const Vec3& p) {
    for (std::size_t n = 0; n < FitPlanes::kCount; ++n) max_[n] = std::max(max_[n], planes.at(n, p));
  }
  void include(const FitExtents& other) {
    for (std::size_t n = 0; n < FitPlanes::kCount; ++n) max_[n] = std::max(max_[n], other.max_[n]);
  }
  /// Replaces each point by a box around it. `reach`: half the side of the box, in the planes' coordinates.
  void grow(const FitPlanes& planes, double reach);

 private:
  std::array<double, FitPlanes::kCount> max_{};
};

/// Fit of points into the picture of a camera, whose zoom and centre do not matter.
class FitFrame {
 public:
  /// Size of fitted points relative to the picture. The rest is the margin.
  static constexpr double kFill = 0.96;

  /// kUsage as for view_of().
  [[nodiscard]] static Result<FitFrame> of(const Camera& camera, const PictureSize& size,
                                           const Display& display);

  /// The camera at zoom 1, around the centre of the bounding sphere, and its view.
  [[nodiscard]] const Camera& whole() const { return camera_; }
  [[nodiscard]] const View& view() const { return view_; }
  /// The functions on points that `to_lps_mm` maps to LPS mm.
  [[nodiscard]] FitPlanes planes(const Affine& to_lps_mm) const;
  /// The camera whose picture the points fill: with margins on both sides of its width, or of its height, and
  /// at least these margins on the other sides. The centre is in the middle of the points, also in depth; in
  /// perspective, the shorter side of the points may be off the middle of the picture. All points are in
  /// front of the eye; with fields of view above 90 degrees, this can take more room than the margins. Clamps
  /// the zoom to [kMinCameraZoom, kMaxCameraZoom]. `extents` must not be empty.
  [[nodiscard]] Camera fitted(const FitExtents& extents) const;

 private:
  FitFrame(const Camera& camera, const View& view);

  Camera camera_;
  View view_;
  double half_height_mm_;  // of the picture in the plane of the centre, at zoom 1
  double aspect_;          // width / height
  double slope_;           // half the height of the picture / distance from the eye; 0: parallel
};

}  // namespace splatlas
