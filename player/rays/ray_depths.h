// Depths of volumes in frames of rays.
#pragma once

#include <array>

#include "player/depth_cue/depth_edges.h"
#include "player/rays/cast_rays.h"
#include "player/rays/pixel_rays.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Positions t along the rays of a packet at which the transmittance falls to `transmittance`, to about a
/// tenth of a slab; kBackground for rays that stay above it. Cost: linear in the volume along the rays.
[[nodiscard]] std::array<float, kPacketRays> depths_along(const MarchScene& scene, const RayPacket& rays,
                                                          float transmittance, const MarchKernels& kernels);

/// Merges the depths of volumes into `depths`, by minimum: points at which the transmittance of a ray falls
/// to one half, sampled once per slab.
void add_ray_depths(const RayVolume& volume, const View& view, const Grid& grid, const MarchKernels& kernels,
                    const ViewDepth& view_depth, DepthMap& depths, ThreadPool& pool);

}  // namespace splatlas
