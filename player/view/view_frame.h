// View frame in object space.
#pragma once

#include "format/grid.h"
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

}  // namespace splatlas
