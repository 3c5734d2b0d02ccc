// Extent of the kept part of a box in sheared object space.
#pragma once

#include <span>

#include "format/content/grid.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Extent in (u, v) of the part of a box that the planes keep, with a margin for slabs and pixels. `first`,
/// `last`: corners in continuous voxel indices.
struct SheetExtent {
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
};
[[nodiscard]] SheetExtent kept_extent(std::span<const VoxelPlane> planes, const Vec3& first, const Vec3& last,
                                      const Shear& shear);

}  // namespace splatlas
