// Grid axis along which the depths of fragments are measured.
#pragma once

#include <cstddef>
#include <optional>

#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas {

struct DepthAxis {
  std::size_t axis = 2;
  double sign = 1;  ///< depth is sign * index along the axis: it increases along every ray
};

/// The principal axis of a view. If some rays of a perspective view run along its planes of voxels, where
/// depths locate no fragment: the axis whose planes all rays cross most steeply. None if there is none.
[[nodiscard]] std::optional<DepthAxis> depth_axis(const View& view, const Grid& grid);

}  // namespace splatlas
