// Picking of structures in a frame by ray casting.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/surfaces/rasterize.h"
#include "player/render/transfer/volume_appearances.h"
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

/// Scene of the latest frame.
struct PickScene {
  const ShownFrame& frame;
  const Grid& grid;
  const SelectedRuns& runs;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;
  const ClassCache& cache;
  const FragmentList& fragments;
  const IdImage& ids;  ///< of the frame; empty: none
};

/// Casts a ray through picture coordinates (x, y) and composites nearest voxels and fragments front to back.
/// Returns the structure with the largest contribution, and the point of its largest contribution. An id
/// image decides about the structure, if there is one and the ray meets that structure. None for the
/// background and outside the picture. Samples one voxel in each slice of the frame; after ray casting, in
/// each plane normal to the major axis of the ray.
[[nodiscard]] std::optional<Pick> pick_structure(const PickScene& scene, double x, double y);

}  // namespace splatlas
