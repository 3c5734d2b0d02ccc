// From a place along a grid's axis to how far away it is.
#pragma once

#include <array>
#include <cmath>

#include "format/grid.h"
#include "player/camera.h"
#include "player/view/view_frame.h"

namespace splatlas {

/// Depths of points on the rays of a view.
class ViewDepth {
 public:
  ViewDepth(const View& view, const Grid& grid);

  /// In mm along the view, from the plane of the centre: of the ray through picture coordinates (x, y) where
  /// it is at `index` (continuous) along an axis of the grid.
  [[nodiscard]] double mm(double x, double y, std::size_t axis, double index) const {
    const double on_plane = frame_.corner[axis] + x * frame_.right[axis] + y * frame_.down[axis];
    if (!perspective_) return (index - on_plane) / frame_.forward[axis];
    return ((index - frame_.eye[axis]) / (on_plane - frame_.eye[axis]) - 1) * eye_mm_;
  }
  /// The point of that ray at that depth, as continuous indices.
  [[nodiscard]] Vec3 index_at(double x, double y, double depth_mm) const;

 private:
  bool perspective_;
  double eye_mm_;
  ViewFrame frame_;  // voxels
};

}  // namespace splatlas
