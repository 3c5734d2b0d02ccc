// Triangles that reach behind the eye or far beside the picture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/surface.h"
#include "player/view/projection.h"

namespace splatlas {

/// Nothing is drawn nearer to the eye than this share of its distance from the centre of the view.
inline constexpr double kNearPlane = 1e-4;
/// Pixels beside the picture: vertices in 1/256 pixel then fit 29 bits, and edge functions 64.
inline constexpr double kGuardBand = double{1 << 20};

/// A part of a triangle that can be rasterised.
struct ClippedTriangle {
  std::uint32_t triangle = 0;
  std::array<ScreenPoint, 3> corner;
  std::array<std::array<double, 3>, 3> weights{};  ///< of the triangle's corners, for each corner
};

/// Adds what of a triangle is before the near plane and within the guard band, wound as the triangle is; at
/// most six parts. Triangles with a corner that is not finite leave nothing. Neighbours stay watertight: what
/// is cut off an edge does not depend on the triangle. (Sutherland and Hodgman 1974, in homogeneous
/// coordinates.)
void clip_triangle(const SurfaceMesh& mesh, std::uint32_t triangle, const Projection& projection,
                   std::vector<ClippedTriangle>& parts);

}  // namespace splatlas
