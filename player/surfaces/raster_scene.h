// Scene description for the rasteriser.
#pragma once

#include <cstddef>
#include <span>

#include "player/surfaces/triangle_bins.h"
#include "player/transfer/facing.h"
#include "player/transfer/shading.h"
#include "player/view/projection.h"
#include "player/view/shear.h"

namespace splatlas {

struct RasterScene {
  std::span<const SurfaceDraw> surfaces;
  PictureSize size;
  Projection projection;
  Facing facing;
  const Lighting& lighting;
  std::size_t depth_axis = 2;  ///< principal axis of the view, an axis of the grid
  double depth_sign = 1;       ///< depth is depth_sign * index along depth_axis
  float pixel_voxels = 1;      ///< width of a pixel in voxels of depth_axis
};
/// The scene of a parallel view; arguments must outlive it.
[[nodiscard]] RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view,
                                       const Shear& shear, const Grid& grid, const Lighting& lighting);

}  // namespace splatlas
