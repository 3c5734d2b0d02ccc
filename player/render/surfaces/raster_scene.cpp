#include "player/render/surfaces/raster_scene.h"

#include <cmath>

namespace splatlas {

Facing::Facing(const Grid& grid) {
  const Affine to_lps = index_to_lps_mm(grid);
  std::array<Vec3, 3> rows{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) rows[r][c] = to_lps.linear[3 * r + c];
  }
  // (M a) x (M b) = cofactors(M) (a x b)
  for (std::size_t r = 0; r < 3; ++r) normal_to_lps_[r] = cross(rows[(r + 1) % 3], rows[(r + 2) % 3]);
}

bool Facing::shows_front(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& corners,
                         bool clockwise) const {
  Vec3 first{};
  Vec3 second{};
  Vec3 front{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double origin = mesh.positions_ijk[corners[0]][a];
    first[a] = mesh.positions_ijk[corners[1]][a] - origin;
    second[a] = mesh.positions_ijk[corners[2]][a] - origin;
    for (const std::uint32_t corner : corners) front[a] += static_cast<double>(mesh.normals_lps[corner][a]);
  }
  const Vec3 normal_ijk = cross(first, second);
  const Vec3 normal{dot(normal_to_lps_[0], normal_ijk), dot(normal_to_lps_[1], normal_ijk),
                    dot(normal_to_lps_[2], normal_ijk)};
  const double to_front = dot(normal, front);
  if (!(std::abs(to_front) > 0)) return true;
  // The geometric normal points to the side that sees the corners counter-clockwise.
  return std::signbit(to_front) == clockwise;
}

RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view, const Shear& shear,
                         const Grid& grid, const Lighting& lighting) {
  const Vec3 along = lps_mm_to_index(grid).apply_linear(view.forward_lps);
  const double voxels_per_mm = std::abs(along[shear.scan.slice_axis]);
  return {surfaces,
          view.size,
          Projection(view, grid),
          Facing(grid),
          lighting,
          shear.scan.slice_axis,
          shear.ascending ? 1.0 : -1.0,
          static_cast<float>(view.mm_per_pixel * voxels_per_mm)};
}

}  // namespace splatlas
