// Projection from continuous voxel indices to screen space.
#pragma once

#include <array>
#include <limits>

#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas {

/// A point in screen space.
struct ScreenPoint {
  double x = 0, y = 0;  ///< in pixels; pixel centres are integers
  double w = 1;         ///< depth from the eye relative to the view's centre; 1 in a parallel view
};

/// Parallel or perspective projection. The eye of a perspective view is `eye_mm` in front of the plane
/// through the view's centre; both projections agree in that plane. An infinite `eye_mm` is a parallel view.
class Projection {
 public:
  Projection(const ParallelView& view, const Grid& grid,
             double eye_mm = std::numeric_limits<double>::infinity());

  [[nodiscard]] bool is_parallel() const { return parallel_; }
  /// Homogeneous coordinates (w * x, w * y, w): affine in `p`, also behind the eye.
  [[nodiscard]] ScreenPoint homogeneous(const std::array<float, 3>& p) const {
    return {x_[0] * p[0] + x_[1] * p[1] + x_[2] * p[2] + x0_,
            y_[0] * p[0] + y_[1] * p[1] + y_[2] * p[2] + y0_,
            parallel_ ? 1 : w_[0] * p[0] + w_[1] * p[1] + w_[2] * p[2] + w0_};
  }
  /// Screen coordinates after the perspective division, for points in front of the eye.
  [[nodiscard]] ScreenPoint on_screen(const std::array<float, 3>& p) const {
    const ScreenPoint point = homogeneous(p);
    return parallel_ ? point : ScreenPoint{point.x / point.w, point.y / point.w, point.w};
  }

 private:
  bool parallel_;
  Vec3 x_{0, 0, 0}, y_{0, 0, 0}, w_{0, 0, 0};
  double x0_ = 0, y0_ = 0, w0_ = 1;
};

}  // namespace splatlas
