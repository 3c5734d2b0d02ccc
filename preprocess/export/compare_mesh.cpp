#include "preprocess/export/compare_mesh.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Compares within the precision of VTK's text output, six digits.
bool is_same(const Vec3& a, const Vec3& b) {
  constexpr double kTolerance = 1e-5;
  for (std::size_t n = 0; n < 3; ++n) {
    if (!(std::abs(a[n] - b[n]) <= kTolerance * std::max(1.0, std::abs(a[n])))) return false;
  }
  return true;
}

/// True for triangles that may degenerate when rounded to six digits.
bool is_thin(const Corners& corners) {
  constexpr double kThinness = 1e-4;
  Vec3 a, b;
  for (std::size_t n = 0; n < 3; ++n) {
    a[n] = corners[1][n] - corners[0][n];
    b[n] = corners[2][n] - corners[0][n];
  }
  const double area =
      std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  const double longest = std::max(std::hypot(a[0], a[1], a[2]), std::hypot(b[0], b[1], b[2]));
  return !(area > kThinness * longest * std::max(1.0, longest));
}

}  // namespace

bool holds_triangles(const TriangleMesh& file, std::span<const Corners> written) {
  std::size_t next = 0;
  for (const Corners& corners : written) {
    const auto is_next = [&] {
      const auto& triangle = file.triangles[next];
      for (std::size_t n = 0; n < 3; ++n) {
        if (!is_same(corners[n], file.positions_lps_mm[triangle[n]])) return false;
      }
      return true;
    };
    if (next < file.triangles.size() && is_next()) {
      ++next;
    } else if (!is_thin(corners)) {
      return false;
    }
  }
  return next == file.triangles.size();
}

}  // namespace splatlas
