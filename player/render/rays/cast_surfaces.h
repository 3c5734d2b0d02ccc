// Surfaces inside volumes by ray casting, in exact order.
#pragma once

#include <span>

#include "player/render/rays/cast_rays.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/raster_scene.h"

namespace splatlas {

/// Scene of the rasteriser for frames of rays, in either projection. kUsage if there is no depth_axis():
/// fields of view wider than about 70 degrees, from some directions.
[[nodiscard]] Result<RasterScene> raster_scene_of_rays(std::span<const SurfaceDraw> surfaces,
                                                       const View& view, const Grid& grid,
                                                       const Lighting& lighting);

/// Renders the pixels with fragments again. The ray of each sample alternates between the volume up to the
/// next fragment and the fragment; the pixel is the mean of its samples. Fragments are those of `scene`.
/// `picture`: null to find the ids alone. Cost: linear in the samples and the volume along their rays.
void cast_surfaces(const RayVolume& volume, const View& view, const Grid& grid, const RasterScene& scene,
                   const FragmentList& fragments, const CastOptions& options, const MarchKernels& kernels,
                   Picture* picture, ThreadPool& pool);

}  // namespace splatlas
