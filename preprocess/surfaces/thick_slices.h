// Smoothing of surfaces across thick slices.
#pragma once

#include <cstdint>
#include <span>

#include "format/content/grid.h"
#include "format/content/surface.h"

namespace splatlas {

/// Steps per voxel of the positions of surfaces smoothed across slices. No rule of derived surfaces has this
/// scale.
inline constexpr std::uint32_t kThickSliceScale = 128;

/// True if voxels are more than twice as long along one axis as along another.
[[nodiscard]] bool has_thick_slices(const Grid& grid);

/// Smooths surfaces of SurfaceRule::kSmooth further, where labels step from slice to slice. Moves vertices
/// onto planes through the triangles around them, across the vertices' normals (Sun et al. 2007, "Fast and
/// effective feature-preserving mesh denoising", vertex updating). So planes and tubes keep their thickness.
/// A vertex moves at most half the longest side of a voxel. Structures share the vertices on a voxel edge:
/// those that touch keep one border. Positions become multiples of 1 / kThickSliceScale; normals and
/// triangles stay. Empty meshes stay. The result does not depend on `threads`. Memory: about 130 bytes per
/// vertex. Cost: about 1 us per triangle.
void smooth_across_slices(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads);

}  // namespace splatlas
