// Where the picture shows a point: the projection of triangles.
#pragma once

#include <array>
#include <limits>

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas {

/// A point as the picture shows it.
struct ScreenPoint {
  double x = 0, y = 0;  ///< in pixels; pixel centres are whole numbers
  double w = 1;         ///< distance from the eye over the centre's; 1 in a parallel view
};

/// Continuous voxel indices to the picture. A perspective view shows what the parallel view shows, exactly so
/// in the plane of its centre, from an eye `eye_mm` in front of that plane; a parallel view's eye is
/// infinitely far away.
class Projection {
 public:
  Projection(const ParallelView& view, const Grid& grid,
             double eye_mm = std::numeric_limits<double>::infinity());

  [[nodiscard]] bool is_parallel() const { return parallel_; }
  /// (w * x, w * y, w): linear in the point, whatever is behind the eye.
  [[nodiscard]] ScreenPoint homogeneous(const std::array<float, 3>& p) const {
    return {x_[0] * p[0] + x_[1] * p[1] + x_[2] * p[2] + x0_,
            y_[0] * p[0] + y_[1] * p[1] + y_[2] * p[2] + y0_,
            parallel_ ? 1 : w_[0] * p[0] + w_[1] * p[1] + w_[2] * p[2] + w0_};
  }
  /// For points in front of the eye.
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
