// Picking of structures in a frame by ray casting.
#pragma once

#include <optional>
#include <span>

#include "player/picture.h"
#include "player/render/contributions/shown_frame.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

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
