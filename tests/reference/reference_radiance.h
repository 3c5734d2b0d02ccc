// Transfer functions, lighting and compositing in double precision.
#pragma once

#include <array>

#include "format/content/color.h"
#include "format/content/transfer_curve.h"
#include "player/camera.h"

namespace splatlas::reference {

/// Linear RGB of an sRGB colour (IEC 61966-2-1).
[[nodiscard]] std::array<double, 3> linear_of(Rgb color);

/// The transfer function at a grey value; not-a-number maps to the first point.
[[nodiscard]] TransferValue transfer(const TransferCurve& curve, double grey, double reference_length_mm);

/// Diffuse shading of a voxel, lit over the viewer's left shoulder. The normal's sign does not matter.
[[nodiscard]] double diffuse(const ParallelView& view, const Vec3& normal_lps);
/// Shading of a surface. The normal belongs to the visible side.
[[nodiscard]] std::array<double, 3> shade_surface(const ParallelView& view,
                                                  const std::array<double, 3>& color, const Vec3& normal_lps);

/// Radiance and transmittance of a ray segment.
struct RayRadiance {
  std::array<double, 3> color{0, 0, 0};
  double transmittance = 1;

  /// Premultiplied.
  [[nodiscard]] std::array<double, 4> rgba() const {
    return {color[0], color[1], color[2], 1 - transmittance};
  }
  /// Composites `further` behind (Porter and Duff 1984, over).
  void add(const RayRadiance& further);
  void add_surface(const std::array<double, 4>& premultiplied);
  /// Adds to a weighted sum. Such a sum begins with a transmittance of 0.
  void add_weighted(double weight, const RayRadiance& other);
};

}  // namespace splatlas::reference
