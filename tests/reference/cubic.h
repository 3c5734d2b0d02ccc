// Cubic polynomial: a trilinear field along a ray within a cell.
#pragma once

#include <array>

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

}  // namespace splatlas::reference
