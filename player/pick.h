// What is under the pointer.
#pragma once

#include <optional>
#include <span>

#include "player/fragments.h"
#include "player/render_frame.h"
#include "player/selected_runs.h"
#include "player/shear.h"
#include "player/volume_looks.h"

namespace splatlas {

/// What the latest frame was made from.
struct PickScene {
  const Grid& grid;
  const SelectedRuns& runs;
  const DrawPlan& plan;
  std::span<const VolumeLook> looks;
  const ClassCache& cache;
  const FragmentList& fragments;
};

/// Follows the ray through picture coordinates (x, y) front to back, from voxel to nearest voxel and fragment
/// to fragment, and returns the structure that contributes most, at the depth where it contributes most.
[[nodiscard]] std::optional<Pick> pick_structure(const PickScene& scene, const ParallelView& view,
                                                 const Shear& shear, double x, double y);

}  // namespace splatlas
