// Errors against closed forms: ripple of constant plates, and orders of convergence on a smooth field.
#pragma once

#include <string>
#include <vector>

#include "format/result.h"
#include "player/renderer.h"

namespace splatlas {

/// Largest error of any channel of any pixel against the closed form, of full scale.
struct Ripple {
  double faces_of_slices = 0;  ///< rays along the normal of the plate: slices are parallel to faces
  double side_faces = 0;       ///< rays along another axis: slices cut through the faces
};

/// A wide plate of one grey value is flat where rays cross its two large faces: all of them have the same
/// length inside it. `views` of each of three plates, normal to x, y and z, have random directions, zooms and
/// subvoxel shifts, equal in every run. In perspective the field of view is narrow.
[[nodiscard]] Result<Ripple> measure_ripple(Quality quality, CameraProjection projection, int views);

/// One renderer on finer and finer grids of a smooth field (a Gaussian).
struct Convergence {
  std::string renderer;        ///< renderer and quality
  std::vector<double> errors;  ///< RMS of full scale, coarse to fine: voxels of 1.5, 1 and 0.75 mm
  double order = 0;            ///< slope of the errors' logarithm: 2 if halving the voxels quarters the error
};

/// Sheets and rays against the closed form of the field itself. Trilinear reconstruction and
/// constant slabs are of second order.
[[nodiscard]] Result<std::vector<Convergence>> measure_convergence();

}  // namespace splatlas
