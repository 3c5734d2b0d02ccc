// Geometry of a finished frame.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "player/camera.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/surfaces/rasterize.h"
#include "player/render_options.h"

namespace splatlas {

/// Geometry of a finished frame, for picking and depth maps.
struct ShownFrame {
  View view;
  std::optional<Axis> sheets;  ///< normal of the slices; none: ray casting
  std::size_t depth_axis = 2;  ///< fragment depth: `depth_sign` * position along this axis, in voxels
  double depth_sign = 1;
  RasterOptions raster = {};  ///< of its surfaces
  CutPlanes cuts = {};
  CapMode caps = CapMode::kNone;
  std::shared_ptr<const CutFaces> faces = nullptr;  ///< null: none
  int surface_level = 0;
};

}  // namespace splatlas
