// Triangle meshes of structures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace splatlas {

/// Surface of one structure in continuous voxel indices of the storage grid. A fitted triangle (marching
/// cubes) lies in one cell of eight voxel centres; an external triangle is clipped to one voxel. Triangles
/// are sorted by the memory offset of their voxel: the first boundary voxel in a fitted triangle's cell, or
/// the voxel crossed by an external triangle.
struct SurfaceMesh {
  std::vector<std::array<float, 3>> positions_ijk;  ///< multiples of 1 / position_scale
  /// Unit normals in LPS, out of the structure, one per position. Files store PackedNormal.
  std::vector<std::array<float, 3>> normals_lps;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside, in LPS
  std::uint32_t position_scale =
      2;  ///< files store positions as integers in units of 1 / position_scale voxel

  friend bool operator==(const SurfaceMesh&, const SurfaceMesh&) = default;
  [[nodiscard]] bool empty() const { return triangles.empty(); }
};

}  // namespace splatlas
