// Cubic polynomials: trilinear fields along a ray within a cell, their radiance, and cubic interpolation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// a[0] + a[1] t + a[2] t^2 + a[3] t^3, t in [0, 1].
struct Cubic {
  std::array<double, 4> a{};

  /// From its values at t = 0, 1/3, 2/3, 1.
  static Cubic through(double f0, double f1, double f2, double f3) {
    return {{f0, (-11 * f0 + 18 * f1 - 9 * f2 + 2 * f3) / 2, (18 * f0 - 45 * f1 + 36 * f2 - 9 * f3) / 2,
             (-9 * f0 + 27 * f1 - 27 * f2 + 9 * f3) / 2}};
  }
  [[nodiscard]] double operator()(double t) const { return a[0] + t * (a[1] + t * (a[2] + t * a[3])); }
  /// Integral from 0 to t.
  [[nodiscard]] double integral(double t) const {
    return t * (a[0] + t * (a[1] / 2 + t * (a[2] / 3 + t * a[3] / 4)));
  }
};

/// Weight of a pixel at a distance in cubic interpolation (Catmull and Rom 1974).
inline double catmull_rom(double distance) {
  const double d = std::abs(distance);
  if (d < 1) return (1.5 * d - 2.5) * d * d + 1;
  return d < 2 ? ((-0.5 * d + 2.5) * d - 4) * d + 2 : 0;
}

/// Node of a Gauss-Legendre quadrature on [0, 1].
struct Node {
  double at, weight;
};

/// Radiance of the part [t0, t1] of a ray segment of `length_mm` with cubic extinction and smooth
/// emission(t). The optical depth is exact. The colour is a quadrature over optical depths up to 1/4.
template <typename Nodes, typename Emission>
RayRadiance integrate(const Nodes& nodes, const Cubic& extinction, const Emission& emission, double t0,
                      double t1, double length_mm) {
  constexpr double kMaxDepthPerStep = 0.25;
  RayRadiance sum;
  const double depth_before = extinction.integral(t0);
  const double depth = length_mm * (extinction.integral(t1) - depth_before);
  if (!(depth > 0)) return sum;
  const double max_extinction = std::max({extinction(t0), extinction(0.5 * (t0 + t1)), extinction(t1)});
  const int steps = 1 + static_cast<int>(max_extinction * (t1 - t0) * length_mm / kMaxDepthPerStep);
  const double step_part = (t1 - t0) / steps;
  for (int step = 0; step < steps; ++step) {
    for (const Node& node : nodes) {
      const double t = t0 + (step + node.at) * step_part;
      const double transmittance = std::exp(-length_mm * (extinction.integral(t) - depth_before));
      const double weight = length_mm * node.weight * step_part * transmittance;
      const std::array<double, 3> emitted = emission(t);
      for (std::size_t c = 0; c < 3; ++c) sum.color[c] += weight * emitted[c];
    }
  }
  sum.transmittance = std::exp(-depth);
  return sum;
}

}  // namespace splatlas::reference
