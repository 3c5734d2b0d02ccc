// What is under the pointer.
#pragma once

#include <optional>
#include <span>

#include "player/picture.h"
#include "player/spans/selected_runs.h"
#include "player/surfaces/fragments.h"
#include "player/transfer/volume_appearances.h"
#include "player/view/view_depth.h"

namespace splatlas {

/// What the latest frame was made from.
struct PickScene {
  const Grid& grid;
  const SelectedRuns& runs;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;
  const ClassCache& cache;
  const FragmentList& fragments;
  std::size_t depth_axis = 2;  ///< fragments' depths are `depth_sign` times places along it
  double depth_sign = 1;
};

/// Follows the ray through picture coordinates (x, y) front to back, from voxel to nearest voxel and fragment
/// to fragment, and returns the structure that contributes most, at the depth where it contributes most.
/// `axis`: of the grid, along which a voxel is looked at per plane; the one that the ray follows most when
/// not set.
[[nodiscard]] std::optional<Pick> pick_structure(const PickScene& scene, const View& view,
                                                 const std::optional<Axis>& axis, double x, double y);

}  // namespace splatlas
