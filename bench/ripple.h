// Ripple: how far from flat a constant volume is.
#pragma once

#include <cstdint>

#include "format/result.h"
#include "player/render_frame.h"

namespace splatlas {

/// A plate of one grey value, wide in two directions, is flat where rays enter and leave through its two
/// large faces: all of them take the same way through it. It is seen from directions, at zooms and at shifts
/// below a voxel that are random, but the same in every run.
struct RippleOptions {
  Quality quality = Quality::kNormal;
  CameraProjection projection = CameraProjection::kParallel;
  int views = 60;  ///< of each of three plates, normal to x, y and z
};

/// Largest differences of any channel of any pixel to the closed form, in full scales.
struct Ripple {
  double faces_of_slices = 0;  ///< where rays follow the plate's normal most: slices are parallel to faces
  double side_faces = 0;       ///< where rays follow another axis most: slices cut through the faces
  std::uint64_t pixels = 0, side_pixels = 0;  ///< that each of the two was found in
};

/// In perspective a narrow one: the way through the plate is each ray's own.
[[nodiscard]] Result<Ripple> measure_ripple(const RippleOptions& options);

}  // namespace splatlas
