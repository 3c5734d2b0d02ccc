#include <algorithm>
#include <cmath>
#include <cstdint>

#include "player/render/rays/cast_rays.h"
#include "player/render/view/shear.h"

namespace splatlas {
namespace {

constexpr double kFarAway = 1e9;

/// LPS mm to positions counted from voxel `first`.
Affine to_place(const Grid& grid, const Index3& first) {
  Affine map = lps_mm_to_index(grid);
  for (std::size_t a = 0; a < 3; ++a) map.offset[a] -= static_cast<double>(first[a]);
  return map;
}

}  // namespace

RayPoints RayBlock::points(int packet, const PictureSize& size) const {
  RayPoints points;
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    const int x = left * grid.columns + column(packet, n), y = top * grid.rows + row(packet, n);
    points.x[n] = (std::min(x, size.width * grid.columns - 1) + 0.5) / grid.columns;
    points.y[n] = (std::min(y, size.height * grid.rows - 1) + 0.5) / grid.rows;
  }
  return points;
}

std::size_t principal_axis_of(const RayPacket& rays, std::size_t n) {
  std::size_t axis = 0;
  while (axis < 2 && !(std::abs(rays.step[axis][n]) == 1.0f && rays.origin[axis][n] == 0.0f)) ++axis;
  return axis;
}

/// Rays as start + s * direction.
struct PixelRays::Lines {
  std::array<RayNumbers, 3> start, direction;
  RayNumbers direction_mm;  // length of the direction
};

PixelRays::PixelRays(const View& view, const Grid& grid, const Index3& first,
                     const std::optional<Axis>& principal_axis)
    : perspective_(view.eye_mm.has_value()),
      first_(first),
      forced_(principal_axis),
      frame_(view, to_place(grid, first)),
      eye_mm_(view.eye_mm.value_or(0)),
      mm_per_pixel_(view.plane.mm_per_pixel),
      middle_x_(0.5 * view.plane.size.width),
      middle_y_(0.5 * view.plane.size.height) {}

PixelRays::Lines PixelRays::from_eye(const RayPoints& points) const {
  const auto& [x, y] = points;
  Lines lines;
  for (std::size_t a = 0; a < 3; ++a) {
    lines.start[a].fill(frame_.eye[a]);
    // Not a difference of positions, which would cancel far from the origin.
    const double ahead = eye_mm_ * frame_.forward[a], right = frame_.right[a], down = frame_.down[a];
    for (std::size_t n = 0; n < kPacketRays; ++n)
      lines.direction[a][n] = ahead + (x[n] - middle_x_) * right + (y[n] - middle_y_) * down;
  }
  const double slope_per_pixel = mm_per_pixel_ / eye_mm_;
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    const double right = (x[n] - middle_x_) * slope_per_pixel, down = (y[n] - middle_y_) * slope_per_pixel;
    lines.direction_mm[n] = eye_mm_ * std::sqrt(1 + right * right + down * down);
  }
  return lines;
}

PixelRays::Lines PixelRays::side_by_side(const RayPoints& points) const {
  const auto& [x, y] = points;
  Lines lines;
  for (std::size_t a = 0; a < 3; ++a) {
    lines.direction[a].fill(frame_.forward[a]);
    const double corner = frame_.corner[a], right = frame_.right[a], down = frame_.down[a];
    for (std::size_t n = 0; n < kPacketRays; ++n) lines.start[a][n] = corner + x[n] * right + y[n] * down;
  }
  lines.direction_mm.fill(1.0);
  return lines;
}

/// The axis along which a ray crosses most voxels, or the forced axis.
std::size_t PixelRays::principal_axis(const Lines& lines, std::size_t n) const {
  const auto voxels = [&](std::size_t axis) { return std::abs(lines.direction[axis][n]); };
  std::size_t principal = 2;
  for (const std::size_t axis : {1u, 0u}) {
    if (voxels(axis) > voxels(principal)) principal = axis;
  }
  if (!forced_) return principal;
  const auto axis = static_cast<std::size_t>(*forced_);
  return voxels(axis) * kMaxForcedSlope >= voxels(principal) ? axis : principal;
}

/// True if this is the only principal axis of all rays. Counts without branches, to be vectorised.
bool PixelRays::is_principal(const Lines& lines, std::size_t axis) const {
  if (forced_) return false;
  std::int64_t others = 0;
  for (const std::size_t other : {(axis + 1) % 3, (axis + 2) % 3}) {
    for (std::size_t n = 0; n < kPacketRays; ++n)
      others += std::abs(lines.direction[other][n]) >= std::abs(lines.direction[axis][n]) ? 1 : 0;
  }
  return others == 0;
}

/// Rays [first, last) of a packet.
void PixelRays::set_rays(const Lines& lines, std::size_t principal, std::size_t first, std::size_t last,
                         RayPacket& packet) const {
  const bool begins_at_eye = perspective_;
  RayNumbers along, t_start;
  for (std::size_t n = first; n < last; ++n) {
    const double ahead = lines.direction[principal][n], start = lines.start[principal][n];
    along[n] = 1 / std::abs(ahead);
    t_start[n] = ahead > 0 ? start : -start;
    packet.mm_per_t[n] = static_cast<float>(lines.direction_mm[n] * along[n]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t n = first; n < last; ++n) {
      const double step = lines.direction[a][n] * along[n];
      packet.step[a][n] = static_cast<float>(step);
      packet.origin[a][n] = static_cast<float>(lines.start[a][n] - step * t_start[n]);
    }
  }
  for (std::size_t n = first; n < last; ++n) {
    packet.step[principal][n] = lines.direction[principal][n] > 0 ? 1.0f : -1.0f;
    packet.origin[principal][n] = 0;
    const double eye = std::min(std::max(t_start[n], -kFarAway), kFarAway);
    packet.from[n] = static_cast<float>(begins_at_eye ? eye : -kFarAway);
    packet.to[n] = kFarAway;
  }
}

RayPacket PixelRays::through(const RayPoints& points) const {
  const Lines lines = perspective_ ? from_eye(points) : side_by_side(points);
  RayPacket packet;
  if (const std::size_t principal = principal_axis(lines, 0); is_principal(lines, principal)) {
    set_rays(lines, principal, 0, kPacketRays, packet);
    return packet;
  }
  for (std::size_t n = 0; n < kPacketRays; ++n) set_rays(lines, principal_axis(lines, n), n, n + 1, packet);
  return packet;
}

void PixelRays::clip(const CutRays& cuts, const RayPoints& points, RayPacket& packet) const {
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    const double x = points.x[n], y = points.y[n];
    const ClipInterval kept = cuts.through(x, y);
    if (kept.empty()) {
      packet.to[n] = packet.from[n];
      continue;
    }
    const std::size_t axis = principal_axis_of(packet, n);
    const auto t_of = [&](double along_ray) {
      const double place = cuts.index_at(x, y, along_ray, axis) - static_cast<double>(first_[axis]);
      return std::clamp(static_cast<double>(packet.step[axis][n]) * place, -kFarAway, kFarAway);
    };
    if (kept.front != ClipInterval::kNoPlane)
      packet.from[n] = std::max(packet.from[n], static_cast<float>(t_of(kept.from)));
    if (kept.back != ClipInterval::kNoPlane)
      packet.to[n] = std::min(packet.to[n], static_cast<float>(t_of(kept.to)));
  }
}

}  // namespace splatlas
