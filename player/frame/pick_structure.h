// Picking of structures in a frame by ray casting.
#pragma once

#include <optional>
#include <span>

#include "player/picture.h"
#include "player/spans/selected_runs.h"
#include "player/surfaces/fragments.h"
#include "player/transfer/volume_appearances.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// Scene of the latest frame.
struct PickScene {
  const Grid& grid;
  const SelectedRuns& runs;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;
  const ClassCache& cache;
  const FragmentList& fragments;
  std::size_t depth_axis = 2;  ///< fragment depth: `depth_sign` * position along this axis, in voxels
  double depth_sign = 1;
};

/// Casts a ray through picture coordinates (x, y) and composites nearest voxels and fragments front to back.
/// Returns the structure with the largest contribution, and the point of its largest contribution. None for
/// the background and outside the picture. `axis`: samples one voxel in each plane normal to it; not set: the
/// major axis of the ray. O(planes of the selection).
[[nodiscard]] std::optional<Pick> pick_structure(const PickScene& scene, const View& view,
                                                 const std::optional<Axis>& axis, double x, double y);

}  // namespace splatlas
