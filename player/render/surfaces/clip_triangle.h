// Clipping of triangles against the near plane and the guard band.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/content/surface.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Near plane, relative to the distance from the eye to the view's centre.
inline constexpr double kNearPlane = 1e-4;
/// Limit of screen coordinates in pixels: vertices in 1/256 pixel fit 29 bits, and edge functions 64 bits.
inline constexpr double kGuardBand = double{1 << 20};

/// Part of a triangle inside the clip planes.
struct ClippedTriangle {
  std::uint32_t triangle = 0;
  std::array<ScreenPoint, 3> corner;
  std::array<std::array<double, 3>, 3> weights{};  ///< barycentric coordinates of each corner
};

/// Clips a triangle against the near plane and the guard band in homogeneous coordinates (Sutherland and
/// Hodgman 1974). Appends at most six parts, with the winding of the triangle. Triangles with a corner that
/// is not finite yield none. Shared edges stay watertight: their clipping is independent of the triangle.
void clip_triangle(const SurfaceMesh& mesh, std::uint32_t triangle, const Projection& projection,
                   std::vector<ClippedTriangle>& parts);

}  // namespace splatlas
