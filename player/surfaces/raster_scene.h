// What the rasteriser draws, and how it is seen.
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
  std::size_t depth_axis = 2;  ///< of the grid: the principal one
  double depth_sign = 1;       ///< depth is that times the index along the axis
  float pixel_voxels = 1;      ///< a pixel's width along the axis
};
[[nodiscard]] RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view,
                                       const Shear& shear, const Grid& grid, const Lighting& lighting);

}  // namespace splatlas
