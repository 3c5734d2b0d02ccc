#include "player/render/clip/cut_rays.h"

#include <cmath>

namespace splatlas {

std::vector<VoxelPlane> voxel_planes(const CutPlanes& planes, const Grid& grid) {
  const Affine to_lps = index_to_lps_mm(grid);
  std::vector<VoxelPlane> of_grid;
  for (const CutPlane& plane : planes) {
    // Scale the normal to length 1 before products can overflow
    Vec3 normal_lps = plane.normal_lps;
    const double length_lps = std::hypot(normal_lps[0], normal_lps[1], normal_lps[2]);
    for (double& component : normal_lps) component /= length_lps;
    VoxelPlane voxels;
    for (std::size_t a = 0; a < 3; ++a) {
      voxels.normal[a] = 0;
      for (std::size_t row = 0; row < 3; ++row)
        voxels.normal[a] += normal_lps[row] * to_lps.linear[3 * row + a];
    }
    const double length = std::sqrt(dot(voxels.normal, voxels.normal));
    for (double& component : voxels.normal) component /= length;
    voxels.offset = (plane.offset_mm / length_lps - dot(normal_lps, to_lps.offset)) / length;
    of_grid.push_back(voxels);
  }
  return of_grid;
}

CutRays::CutRays(const CutPlanes& planes, const View& view, const Grid& grid, double margin)
    : perspective_(view.eye_mm.has_value()),
      frame_(view, lps_mm_to_index(grid)),
      planes_(voxel_planes(planes, grid)) {
  for (VoxelPlane& plane : planes_) {
    plane.offset -= margin;
    RayDistance distance;
    if (perspective_) {
      Vec3 ahead = frame_.corner;
      for (std::size_t a = 0; a < 3; ++a) ahead[a] -= frame_.eye[a];
      distance = {
          plane.distance(frame_.eye),    0, 0, dot(plane.normal, ahead), dot(plane.normal, frame_.right),
          dot(plane.normal, frame_.down)};
    } else {
      distance = {plane.distance(frame_.corner),
                  dot(plane.normal, frame_.right),
                  dot(plane.normal, frame_.down),
                  dot(plane.normal, frame_.forward),
                  0,
                  0};
    }
    distances_.push_back(distance);
  }
}

ClipInterval CutRays::through(double x, double y) const {
  ClipInterval kept;
  if (perspective_) kept.from = 0;
  for (std::size_t n = 0; n < distances_.size(); ++n) {
    const RayDistance& of = distances_[n];
    const double start = of.start + x * of.start_x + y * of.start_y;
    const double along = of.along + x * of.along_x + y * of.along_y;
    if (along == 0) {
      if (start > 0) kept.to = -std::numeric_limits<double>::infinity();
      continue;
    }
    const double at = -start / along;
    if (along < 0 && at > kept.from) {
      kept.from = at;
      kept.front = static_cast<int>(n);
    } else if (along > 0 && at < kept.to) {
      kept.to = at;
      kept.back = static_cast<int>(n);
    }
  }
  return kept;
}

ClipDepths CutRays::depths(double x, double y, std::size_t axis, double sign) const {
  const ClipInterval kept = through(x, y);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (kept.empty()) return {kInfinity, -kInfinity};
  ClipDepths depths;
  if (std::isfinite(kept.from)) depths.from = sign * index_at(x, y, kept.from, axis);
  if (std::isfinite(kept.to)) depths.to = sign * index_at(x, y, kept.to, axis);
  return depths;
}

CutRays::Row CutRays::row(double y, double width) const {
  Row row{0, width, {}};
  for (std::size_t n = 0; n < distances_.size(); ++n) {
    const RayDistance& of = distances_[n];
    const double start = of.start + y * of.start_y;
    if (of.along != 0) {
      row.crossings.push_back({static_cast<int>(n), of.along < 0, -start / of.along, -of.start_x / of.along});
    } else if (of.start_x == 0) {
      if (start > 0) row.last = -1;
    } else {
      const double at = -start / of.start_x;
      (of.start_x > 0 ? row.last : row.first) =
          of.start_x > 0 ? std::min(row.last, at) : std::max(row.first, at);
    }
  }
  return row;
}

bool CutRays::can_leave() const {
  return perspective_ ||
         std::any_of(distances_.begin(), distances_.end(), [](const auto& of) { return of.along > 0; });
}

std::uint8_t CutRays::removing(const std::array<float, 3>& index) const {
  std::uint8_t planes = 0;
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    const double distance = planes_[n].distance({index[0], index[1], index[2]});
    planes = static_cast<std::uint8_t>(planes | (distance > 0 ? 1u << n : 0u));
  }
  return planes;
}

}  // namespace splatlas
