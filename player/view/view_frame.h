// Where the pixels of a view lie in a frame of the grid's.
#pragma once

#include "format/grid.h"
#include "player/camera.h"

namespace splatlas {

/// A view in a frame that LPS mm are mapped to, voxels as a rule. The point of the plane of the centre that
/// picture coordinates (x, y) show is corner + x * right + y * down.
struct ViewFrame {
  Vec3 eye{};                      ///< View::eye_lps_mm()
  Vec3 corner{}, right{}, down{};  ///< of the picture; per pixel
  Vec3 forward{};                  ///< per mm

  ViewFrame(const View& view, const Affine& from_lps_mm);
};

}  // namespace splatlas
