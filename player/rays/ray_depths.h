// How far away volumes are, in frames of rays.
#pragma once

#include <array>

#include "player/depth_cue/depth_edges.h"
#include "player/rays/cast_rays.h"
#include "player/rays/pixel_rays.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Where each ray of a packet lets through no more than `through`: places along the ray, as RayPacket has
/// them; kBackground where it lets through more to its end. To about a tenth of a slab. Cost: the volume
/// along the rays, at the scene's steps.
[[nodiscard]] std::array<float, kPacketRays> depths_along(const MarchScene& scene, const RayPacket& rays,
                                                          float through, const MarchKernels& kernels);

/// Takes volumes into `depths` where they are nearer: where a ray, sampled once a slab, is let through by no
/// more than a half.
void add_ray_depths(const RayVolume& volume, const View& view, const Grid& grid, const MarchKernels& kernels,
                    const ViewDepth& view_depth, DepthMap& depths, ThreadPool& pool);

}  // namespace splatlas
