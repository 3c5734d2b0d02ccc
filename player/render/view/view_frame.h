// View frame in object space, depth of points on the rays of a view, and projection to screen space.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Eye, image plane and direction of a view after the map `from_lps_mm`, usually to voxel indices. Picture
/// coordinates (x, y) correspond to corner + x * right + y * down in the plane through the view's centre.
struct ViewFrame {
  Vec3 eye{};            ///< View::eye_lps_mm()
  Vec3 corner{};         ///< top left corner of the picture
  Vec3 right{}, down{};  ///< per pixel
  Vec3 forward{};        ///< per mm

  ViewFrame(const View& view, const Affine& from_lps_mm);
};

/// Conversion between depth along a ray and continuous voxel indices. Depths are in mm along the view
/// direction, 0 in the plane through the view's centre.
class ViewDepth {
 public:
  ViewDepth(const View& view, const Grid& grid);

  /// Depth at which the ray through picture coordinates (x, y) reaches a continuous index along a grid axis.
  [[nodiscard]] double mm(double x, double y, std::size_t axis, double index) const {
    const double on_plane = frame_.corner[axis] + x * frame_.right[axis] + y * frame_.down[axis];
    if (!perspective_) return (index - on_plane) / frame_.forward[axis];
    return ((index - frame_.eye[axis]) / (on_plane - frame_.eye[axis]) - 1) * eye_mm_;
  }
  /// Continuous voxel index of the point on that ray at `depth_mm`.
  [[nodiscard]] Vec3 index_at(double x, double y, double depth_mm) const;

 private:
  bool perspective_;
  double eye_mm_;
  ViewFrame frame_;  // voxels
};

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
