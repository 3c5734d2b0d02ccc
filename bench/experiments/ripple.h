// Ripple: deviation of a constant volume from flatness.
#pragma once

#include <cstdint>

#include "format/result.h"
#include "player/renderer.h"

namespace splatlas {

/// A wide plate of one grey value is flat where rays cross its two large faces: all of them have the same
/// length inside it. Views have random directions, zooms and subvoxel shifts, equal in every run.
struct RippleOptions {
  Quality quality = Quality::kNormal;
  CameraProjection projection = CameraProjection::kParallel;
  int views = 60;  ///< per plate; three plates, normal to x, y and z
};

/// Largest error of any channel of any pixel against the closed form, of full scale.
struct Ripple {
  double faces_of_slices = 0;  ///< rays along the normal of the plate: slices are parallel to faces
  double side_faces = 0;       ///< rays along another axis: slices cut through the faces
  std::uint64_t pixels = 0, side_pixels = 0;  ///< pixels of either kind
};

/// Uses a narrow field of view in perspective, with the length of each ray.
[[nodiscard]] Result<Ripple> measure_ripple(const RippleOptions& options);

}  // namespace splatlas
