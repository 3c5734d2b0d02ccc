// Smoothing of surfaces across thick slices.
#pragma once

#include <functional>
#include <span>

#include "format/content/grid.h"
#include "format/content/surface.h"

namespace splatlas {

/// True if voxels are more than twice as long along one axis as along another.
[[nodiscard]] bool has_thick_slices(const Grid& grid);

/// Smooths surfaces of SurfaceRule::kSmooth further, where labels step from slice to slice. Moves vertices
/// onto planes through the triangles around them, across the vertices' normals (Sun et al. 2007, "Fast and
/// effective feature-preserving mesh denoising", vertex updating). So planes and tubes keep their thickness.
/// First, each structure moves alone. Then vertices on one voxel edge are joined if they are still near each
/// other: structures that touch keep one border, and those that meet on ledges between slices part. A vertex
/// moves at most half the longest side of a voxel from the mean of those it is joined with. Positions become
/// multiples of 1 / kThickSliceScale; normals and triangles stay. Thin parts may cross or fold over each
/// other within that distance. Empty meshes stay. `progress` receives the fraction done and may be empty. The
/// result does not depend on `threads`. Memory: about 250 bytes per vertex. Cost: about 1 us per triangle.
void smooth_across_slices(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads,
                          const std::function<void(double)>& progress = {});

}  // namespace splatlas
