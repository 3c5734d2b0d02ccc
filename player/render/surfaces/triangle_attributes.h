// Perspective-correct interpolation of depth and barycentric weights over a triangle.
#pragma once

#include <algorithm>
#include <array>

#include "player/render/surfaces/clip_triangle.h"
#include "player/render/view/projection.h"

namespace splatlas {

/// Attribute set-up of a triangle, done at its first covered sample. It uses vertices before snapping, so
/// that coplanar triangles have equal depths at the same sample, whatever their tessellation.
class TriangleAttributes {
 public:
  /// The mean of values with these weights.
  [[nodiscard]] static double mixed(const std::array<double, 3>& weights,
                                    const std::array<double, 3>& values) {
    return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2];
  }

  /// Screen coordinates and depths of the corners. `part`: the clipped part that they belong to; null: none.
  TriangleAttributes(const std::array<ScreenPoint, 3>& points, const std::array<double, 3>& depths,
                     bool parallel, const ClippedTriangle* part);

  /// True for clockwise corners on the screen, before snapping.
  [[nodiscard]] bool is_clockwise() const { return clockwise_; }
  /// Depth at picture coordinates (x, y) with integer pixel centres, clamped to the depths of the corners.
  /// Snapped triangles may cover samples just outside the original one.
  [[nodiscard]] double depth_at(double x, double y) const {
    double depth = at(depth_, x, y);
    if (!parallel_) depth /= at(inverse_w_, x, y);
    return std::clamp(depth, nearest_, furthest_);
  }
  /// Converts screen-space weights of the rasterised corners to barycentric weights of the mesh's corners.
  void correct(std::array<float, 3>& weight) const {
    if (!parallel_) {
      float sum = 0;
      for (std::size_t n = 0; n < 3; ++n) {
        weight[n] *= static_cast<float>(per_w_[n]);
        sum += weight[n];
      }
      for (float& w : weight) w /= sum;
    }
    if (part_ == nullptr) return;
    const std::array<double, 3> of_part{weight[0], weight[1], weight[2]};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(
          mixed(of_part, {part_->weights[0][n], part_->weights[1][n], part_->weights[2][n]}));
    }
  }

 private:
  /// Linear function in screen space.
  struct ScreenPlane {
    double at_origin = 0, per_x = 0, per_y = 0;
  };

  [[nodiscard]] double at(const ScreenPlane& plane, double x, double y) const {
    return plane.at_origin + plane.per_x * (x - x0_) + plane.per_y * (y - y0_);
  }

  bool parallel_;
  const ClippedTriangle* part_;
  bool clockwise_ = false;
  double x0_ = 0, y0_ = 0, nearest_ = 0, furthest_ = 0;
  std::array<double, 3> per_w_{1, 1, 1};
  ScreenPlane depth_, inverse_w_{1, 0, 0};
};

}  // namespace splatlas
