// Triangle meshes of structures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace splatlas {

/// Rule by which a surface follows from the voxels of its structure (docs/atlas_surfaces.md). The values are
/// the position scales of such surfaces in files.
enum class SurfaceRule : std::uint32_t {
  kVoxels = 4,   ///< vertices midway between voxels, triangles of vtkMarchingCubes
  kSmooth = 256  ///< smoothing 1: vertices moved along their voxel edges, triangles of vtkMarchingCubes
};

/// Position scale of stored surfaces that were smoothed across thick slices. Their structures' voxels have
/// the coarse levels of derived surfaces.
inline constexpr std::uint32_t kThickSliceScale = 128;

/// Maximum size of a grid along each axis for SurfaceRule::kSmooth: positions are exact in single precision.
inline constexpr std::int64_t kMaxSmoothSize = 65535;
/// The rule, or kVoxels instead of kSmooth in a grid that is too large.
[[nodiscard]] inline SurfaceRule rule_for(SurfaceRule rule, const std::array<std::int64_t, 3>& size) {
  const bool is_large = size[0] > kMaxSmoothSize || size[1] > kMaxSmoothSize || size[2] > kMaxSmoothSize;
  return rule == SurfaceRule::kSmooth && is_large ? SurfaceRule::kVoxels : rule;
}

/// Surface of one structure in continuous voxel indices of the storage grid. A fitted triangle (marching
/// cubes) lies in one cell of eight voxel centres, unless it was smoothed across thick slices; external
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
