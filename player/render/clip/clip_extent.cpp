#include "player/render/clip/clip_extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace splatlas {
namespace {

/// Largest distance of a visible slab centre or pixel from the kept part, in voxels.
constexpr double kExtentMargin = 2;

}  // namespace

SheetExtent kept_extent(std::span<const VoxelPlane> planes, const Vec3& first, const Vec3& last,
                        const Shear& shear) {
  // List the half spaces of the box and of the cut
  std::vector<VoxelPlane> all;
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double sign : {-1.0, 1.0}) {
      VoxelPlane side;
      side.normal = {0, 0, 0};
      side.normal[a] = sign;
      side.offset = sign > 0 ? last[a] : -first[a];
      all.push_back(side);
    }
  }
  for (VoxelPlane plane : planes) {
    plane.offset += kExtentMargin;
    all.push_back(plane);
  }

  // Bound the vertices of their intersection
  constexpr double kTolerance = 1e-6, kInfinity = std::numeric_limits<double>::infinity();
  SheetExtent extent{kInfinity, -kInfinity, kInfinity, -kInfinity};
  const auto include = [&](const Vec3& p) {
    for (const VoxelPlane& plane : all) {
      if (plane.distance(p) > kTolerance * (1 + std::abs(plane.offset))) return;
    }
    const double k = p[shear.scan.slice_axis];
    const double u = p[shear.scan.scan_axis] + shear.u_shift(k);
    const double v = p[shear.scan.row_axis] + shear.v_shift(k);
    extent = {std::min(extent.u_min, u), std::max(extent.u_max, u), std::min(extent.v_min, v),
              std::max(extent.v_max, v)};
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t n = j + 1; n < all.size(); ++n) {
        const Vec3 &a = all[i].normal, &b = all[j].normal, &c = all[n].normal;
        const Vec3 bc{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
        const Vec3 ca{c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]};
        const Vec3 ab{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        const double volume = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
        if (std::abs(volume) < 1e-9) continue;
        Vec3 p{};
        for (std::size_t axis = 0; axis < 3; ++axis)
          p[axis] = (all[i].offset * bc[axis] + all[j].offset * ca[axis] + all[n].offset * ab[axis]) / volume;
        include(p);
      }
    }
  }
  return extent;
}

}  // namespace splatlas
