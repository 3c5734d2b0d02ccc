// Surfaces between the parts of the volume, ray by ray.
#pragma once

#include <span>

#include "player/rays/cast_rays.h"
#include "player/surfaces/fragments.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

/// What the rasteriser draws for rays: in perspective, too. kUsage where a ray of the picture runs along the
/// planes of voxels that depths are counted by (fields of view wider than about 70 degrees, from some
/// directions).
[[nodiscard]] Result<RasterScene> raster_scene_of_rays(std::span<const SurfaceDraw> surfaces,
                                                       const View& view, const Grid& grid,
                                                       const Lighting& lighting);

/// Renders the pixels that hold fragments once more: the ray of each sample up to its first fragment, the
/// fragment, the ray up to the next one, and so on; the pixel is the mean of its samples. Fragments are those
/// of `scene`. Cost: samples and the volume along their rays.
void cast_surfaces(const RayVolume& volume, const View& view, const Grid& grid, const RasterScene& scene,
                   const FragmentList& fragments, const CastOptions& options, const MarchKernels& kernels,
                   Picture& picture, ThreadPool& pool);

}  // namespace splatlas
