// Decoded selection, as input of the stages of the player.
#pragma once

#include <memory>

#include "player/spans/class_cache.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// The decoded state of the volumes of a selection, ahead of spans and rays.
struct DecodedSelection {
  DrawPlan plan;
  std::unique_ptr<ClassCache> cache;
  std::unique_ptr<VolumeAppearances> appearances;  ///< per class of the plan
  std::unique_ptr<SelectedRuns> runs;              ///< along one axis
};

/// Reads the runs of a selection along one axis, and its voxels.
[[nodiscard]] Result<DecodedSelection> decode_selection(const std::shared_ptr<const Atlas>& atlas,
                                                        const Selection& selection, Axis axis,
                                                        ThreadPool& pool);

}  // namespace splatlas
