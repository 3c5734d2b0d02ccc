#include "player/pixel_rays.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

constexpr float kFarAway = 1e9f;
/// Another axis than the best one is taken only where no more than so many voxels lie between its planes.
constexpr double kMaxSlope = 100;

/// LPS mm to positions counted from voxel `first`.
Affine to_place(const Grid& grid, const Index3& first) {
  Affine map = lps_mm_to_index(grid);
  for (std::size_t a = 0; a < 3; ++a) map.offset[a] -= static_cast<double>(first[a]);
  return map;
}

}  // namespace

/// At s, a ray is at start + s * direction.
struct PixelRays::Lines {
  std::array<RayNumbers, 3> start{}, direction{};
  RayNumbers direction_mm{};  // length of the direction
};

PixelRays::PixelRays(const View& view, const Grid& grid, const Index3& first,
                     const std::optional<Axis>& principal_axis)
    : perspective_(view.eye_mm.has_value()),
      forced_(principal_axis),
      frame_(view, to_place(grid, first)),
      eye_mm_(view.eye_mm.value_or(0)),
      mm_per_pixel_(view.plane.mm_per_pixel),
      middle_x_(0.5 * view.plane.size.width),
      middle_y_(0.5 * view.plane.size.height) {}

PixelRays::Lines PixelRays::lines(const RayNumbers& x, const RayNumbers& y) const {
  Lines lines;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      if (!perspective_) {
        lines.start[a][n] = frame_.corner[a] + x[n] * frame_.right[a] + y[n] * frame_.down[a];
        lines.direction[a][n] = frame_.forward[a];
        continue;
      }
      // No difference of places: near each other and far from the origin they are the same.
      lines.start[a][n] = frame_.eye[a];
      lines.direction[a][n] = eye_mm_ * frame_.forward[a] + (x[n] - middle_x_) * frame_.right[a] +
                              (y[n] - middle_y_) * frame_.down[a];
    }
  }
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    const double right = (x[n] - middle_x_) * mm_per_pixel_ / eye_mm_;
    const double down = (y[n] - middle_y_) * mm_per_pixel_ / eye_mm_;
    lines.direction_mm[n] = perspective_ ? eye_mm_ * std::sqrt(1 + right * right + down * down) : 1.0;
  }
  return lines;
}

/// The axis along which a ray passes most voxels, or the one that is forced.
std::size_t PixelRays::principal_axis(const Lines& lines, std::size_t n) const {
  const auto voxels = [&](std::size_t axis) { return std::abs(lines.direction[axis][n]); };
  std::size_t principal = 2;
  for (const std::size_t axis : {1u, 0u}) {
    if (voxels(axis) > voxels(principal)) principal = axis;
  }
  if (!forced_) return principal;
  const auto axis = static_cast<std::size_t>(*forced_);
  return voxels(axis) * kMaxSlope >= voxels(principal) ? axis : principal;
}

/// Rays [first, last) of a packet.
void PixelRays::set_rays(const Lines& lines, std::size_t principal, std::size_t first, std::size_t last,
                         RayPacket& packet) const {
  for (std::size_t n = first; n < last; ++n) {
    const double ahead = lines.direction[principal][n];
    const double along = 1 / std::abs(ahead);
    const double t_start = ahead > 0 ? lines.start[principal][n] : -lines.start[principal][n];
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = lines.direction[a][n] * along;
      packet.step[a][n] = static_cast<float>(step);
      packet.origin[a][n] = static_cast<float>(lines.start[a][n] - step * t_start);
    }
    packet.step[principal][n] = ahead > 0 ? 1.0f : -1.0f;
    packet.origin[principal][n] = 0;
    packet.mm_per_t[n] = static_cast<float>(lines.direction_mm[n] * along);
    packet.from[n] =
        perspective_ ? static_cast<float>(std::clamp<double>(t_start, -kFarAway, kFarAway)) : -kFarAway;
    packet.to[n] = kFarAway;
  }
}

RayPacket PixelRays::through(const RayNumbers& x, const RayNumbers& y) const {
  const Lines all = lines(x, y);
  RayPacket packet;
  std::size_t first = 0;
  while (first < kPacketRays) {  // mostly all at once
    const std::size_t principal = principal_axis(all, first);
    std::size_t last = first + 1;
    while (last < kPacketRays && principal_axis(all, last) == principal) ++last;
    set_rays(all, principal, first, last, packet);
    first = last;
  }
  return packet;
}

}  // namespace splatlas
