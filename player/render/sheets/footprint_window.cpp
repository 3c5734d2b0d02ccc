#include "player/render/sheets/footprint_window.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {
namespace {

/// Extent in (u, v) of the part of a box that the planes keep, with a margin for slabs and pixels. `first`,
/// `last`: corners in continuous voxel indices.
struct SheetExtent {
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
};

/// Largest distance of a visible slab centre or pixel from the kept part, in voxels.
constexpr double kExtentMargin = 2;

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
        const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
        const double volume = dot(a, bc);
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

/// Extent of a region of the picture, padded for interpolation.
SheetExtent shown_extent(const Shear& shear, const PixelBox& region, bool cubic) {
  const double around = cubic ? 2 : 1;
  const Affine2& map = shear.picture_to_sheet;
  const auto shown = [&](double per_x, double per_y, double origin) {
    const double at = origin + per_x * region.x_first + per_y * region.y_first;
    const double x = per_x * region.width(), y = per_y * region.height();
    return std::pair(at + std::min(x, 0.0) + std::min(y, 0.0) - around,
                     at + std::max(x, 0.0) + std::max(y, 0.0) + around);
  };
  const auto [u_min, u_max] = shown(map.xx, map.xy, map.x0);
  const auto [v_min, v_max] = shown(map.yx, map.yy, map.y0);
  return {u_min, u_max, v_min, v_max};
}

}  // namespace

SheetWindow part_of_window(const SheetWindow& window, const Shear& shear, const PixelBox& region) {
  SheetWindow part = window;
  const SheetExtent shown = shown_extent(shear, region, window.cubic);
  const auto voxel = [](double at, std::int64_t first, std::int64_t count) {
    return static_cast<std::int64_t>(
        std::clamp(at, static_cast<double>(first), static_cast<double>(first + count)));
  };
  const std::int64_t u = voxel(std::floor(shown.u_min), window.u0, window.columns);
  part.u0 = window.u0 + (u - window.u0) / kBlock * kBlock;
  part.v0 = voxel(std::floor(shown.v_min), window.v0, window.rows);
  part.columns = voxel(std::ceil(shown.u_max) + 1, window.u0, window.columns) - part.u0;
  part.rows = voxel(std::ceil(shown.v_max) + 1, window.v0, window.rows) - part.v0;
  if (part.empty()) part.columns = part.rows = 0;
  return part;
}

SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                         const SheetSampling& sampling, std::span<const VoxelPlane> planes) {
  SheetWindow window{sampling};
  if (model.voxels == 0) return window;
  // Bound the voxels' projections; a footprint extends one voxel to each side
  const auto seen = [&](double first, double voxels, double shift_first, double shift_last) {
    return std::pair(first - 1 + std::min(shift_first, shift_last),
                     first + voxels + std::max(shift_first, shift_last));
  };
  const double reach = sampling.parts == 1 ? 0 : 1;  // support of a slice along the principal axis
  const double k_first = static_cast<double>(model.slice_first) - reach;
  const double k_last = static_cast<double>(model.slice_first + model.slice_count - 1) + reach;
  auto [u_min, u_max] = seen(static_cast<double>(model.scan_first), static_cast<double>(model.scan_voxels),
                             shear.u_shift(k_first), shear.u_shift(k_last));
  auto [v_min, v_max] = seen(static_cast<double>(model.row_first), static_cast<double>(model.rows),
                             shear.v_shift(k_first), shear.v_shift(k_last));
  if (!planes.empty()) {
    Vec3 low{}, high{};
    const auto set = [&](std::size_t axis, double first, double last) {
      low[axis] = first;
      high[axis] = last;
    };
    set(shear.scan.scan_axis, static_cast<double>(model.scan_first) - 1,
        static_cast<double>(model.scan_first + model.scan_voxels));
    set(shear.scan.row_axis, static_cast<double>(model.row_first) - 1,
        static_cast<double>(model.row_first + model.rows));
    set(shear.scan.slice_axis, k_first - 1, k_last + 1);
    const SheetExtent kept = kept_extent(planes, low, high, shear);
    u_min = std::max(u_min, kept.u_min);
    u_max = std::min(u_max, kept.u_max);
    v_min = std::max(v_min, kept.v_min);
    v_max = std::min(v_max, kept.v_max);
  }

  const auto [u_low, u_high, v_low, v_high] = shown_extent(shear, PixelBox::of(size), sampling.cubic);
  u_min = std::max(u_min, u_low);
  u_max = std::min(u_max, u_high);
  v_min = std::max(v_min, v_low);
  v_max = std::min(v_max, v_high);
  if (!(u_min < u_max && v_min < v_max)) return window;
  window.u0 = static_cast<std::int64_t>(std::floor(u_min));
  window.v0 = static_cast<std::int64_t>(std::floor(v_min));
  window.columns = static_cast<std::int64_t>(std::ceil(u_max)) - window.u0 + 1;
  window.rows = static_cast<std::int64_t>(std::ceil(v_max)) - window.v0 + 1;
  return window;
}

}  // namespace splatlas
