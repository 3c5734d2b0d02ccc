// View frame in object space, and depth of points on the rays of a view.
#pragma once

#include <cstddef>

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

  /// Depth at which the ray through picture coordinates (x, y) reaches the continuous `index` along a grid
  /// axis.
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

}  // namespace splatlas
