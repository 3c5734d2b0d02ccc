#include "player/render/surfaces/raster_scene.h"

#include <cmath>

namespace splatlas {
RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view, const Shear& shear,
                         const Grid& grid, const Lighting& lighting) {
  const Vec3 along = lps_mm_to_index(grid).apply_linear(view.forward_lps);
  const double voxels_per_mm = std::abs(along[shear.scan.slice_axis]);
  return {surfaces,
          view.size,
          PixelBox::of(view.size),
          Projection(view, grid),
          lighting,
          shear.scan.slice_axis,
          shear.ascending ? 1.0 : -1.0,
          static_cast<float>(view.mm_per_pixel * voxels_per_mm)};
}

}  // namespace splatlas
