// Depths of volumes.
#pragma once

#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/depth_cue/depth_edges.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Merges the depths of volumes, clipped by `cuts` unless it is null, into `depths`, by minimum: points at
/// which the transmittance of a ray falls to one half, sampled once per slab.
void add_ray_depths(const RayVolume& volume, const View& view, const Grid& grid, const MarchKernels& kernels,
                    const CutRays* cuts, const ViewDepth& view_depth, DepthMap& depths, ThreadPool& pool);

}  // namespace splatlas
