// Triangle meshes of structures.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

/// Rule by which a surface follows from the voxels of its structure (docs/atlas_surfaces.md). The values are
/// the position scales of such surfaces in files.
enum class SurfaceRule : std::uint32_t {
  kVoxels = 4,    ///< vertices midway between voxels, triangles of vtkMarchingCubes
  kSmooth = 256,  ///< smoothing 1: vertices moved along their voxel edges, triangles of vtkMarchingCubes
  kUneven = 128   ///< smoothing 2: vertices moved off their edges, across slices; the same triangles
};

/// Maximum size of a grid along each axis for rules that smooth: positions are exact in single precision.
inline constexpr std::int64_t kMaxSmoothSize = 65535;
[[nodiscard]] inline bool admits(const Index3& size, SurfaceRule rule) {
  return rule == SurfaceRule::kVoxels || std::ranges::max(size) <= kMaxSmoothSize;
}
/// The rule, or what stands for kSmooth in this grid: kVoxels if it is too large, kUneven if voxels are more
/// than 1.2 times as long along one axis as along another.
[[nodiscard]] inline SurfaceRule rule_for(SurfaceRule rule, const Grid& grid) {
  if (rule != SurfaceRule::kSmooth) return rule;
  if (!admits(grid.size, rule)) return SurfaceRule::kVoxels;
  const double thin = *std::ranges::min_element(grid.spacing_mm), thick = std::ranges::max(grid.spacing_mm);
  return thick > 1.2 * thin ? SurfaceRule::kUneven : rule;
}

/// Surface of one structure in continuous voxel indices of the storage grid. A fitted triangle (marching
/// cubes) lies in one cell of eight voxel centres, unless it was smoothed across slices; external
/// triangles are as in their file. Triangles are sorted by the memory offset of their voxel: the first
/// boundary voxel in a fitted triangle's cell, or the first voxel that an external triangle crosses.
struct SurfaceMesh {
  std::vector<std::array<float, 3>> positions_ijk;  ///< multiples of 1 / position_scale
  /// Unit normals in LPS, out of the structure, one per position. Files store PackedNormal.
  std::vector<std::array<float, 3>> normals_lps;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside, in LPS
  /// Files store positions as integers of 1 / position_scale voxel. Of fitted surfaces: a SurfaceRule.
  std::uint32_t position_scale = 2;

  friend bool operator==(const SurfaceMesh&, const SurfaceMesh&) = default;
  [[nodiscard]] bool empty() const { return triangles.empty(); }
};

/// The size of a surface that fit_surface() derives. Without triangles: none.
struct FittedSurface {
  SurfaceRule rule = SurfaceRule::kSmooth;
  std::uint32_t vertices = 0, triangles = 0;
};

}  // namespace splatlas
