// Light in double precision: transfer function, lamp, and composition.
#pragma once

#include <array>
#include <cstdint>

#include "format/color.h"
#include "format/transfer_curve.h"
#include "player/camera.h"

namespace splatlas::reference {

/// Linear light of an sRGB colour (IEC 61966-2-1).
[[nodiscard]] std::array<double, 3> linear_of(Rgb color);

/// The transfer function at a grey value; the first point's for values that are not a number.
[[nodiscard]] TransferValue transfer(const TransferCurve& curve, double grey, double reference_length_mm);

/// The lamp of the view over the viewer's left shoulder. Of voxels: normals point either way.
[[nodiscard]] double diffuse(const ParallelView& view, const Vec3& normal_lps);
/// Of surfaces: the normal is that of the side which is seen.
[[nodiscard]] std::array<double, 3> shade_surface(const ParallelView& view,
                                                  const std::array<double, 3>& color, const Vec3& normal_lps);

/// The light along some part of a ray: what it sends to the viewer, and what shines through it.
struct RayRadiance {
  std::array<double, 3> color{0, 0, 0};
  double transmittance = 1;

  /// Puts `further` behind.
  void add(const RayRadiance& further);
  void add_surface(const std::array<double, 4>& premultiplied);
};

}  // namespace splatlas::reference
