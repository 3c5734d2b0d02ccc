// Triangle surfaces of structures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace splatlas {

/// The surface of one structure in continuous voxel indices of the storage grid. A fitted triangle (marching
/// cubes) lies in one cell between eight voxel centres; an external one is clipped so that it lies in one
/// voxel. Triangles are sorted by the voxel that leads to them (the boundary voxel of smallest memory offset
/// in a fitted triangle's cell; the crossed voxel of an external one), in memory order of the grid.
struct SurfaceMesh {
  std::vector<std::array<float, 3>> positions_ijk;  ///< multiples of 1 / position_scale
  /// Unit, out of the structure, one per position. Files keep them as PackedNormal.
  std::vector<std::array<float, 3>> normals_lps;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside, in LPS
  std::uint32_t position_scale = 2;  ///< positions are stored exactly as integers of 1 / position_scale voxel

  friend bool operator==(const SurfaceMesh&, const SurfaceMesh&) = default;
  [[nodiscard]] bool empty() const { return triangles.empty(); }
};

}  // namespace splatlas
