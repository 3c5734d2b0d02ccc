// A selection read from an atlas, as the player's stages take it.
#pragma once

#include <memory>

#include "player/spans/class_cache.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// What the player keeps of a selection's volumes before spans or rays are made of it.
struct DecodedSelection {
  DrawPlan plan;
  std::unique_ptr<ClassCache> cache;
  std::unique_ptr<VolumeAppearances> appearances;  ///< of the plan's classes
  std::unique_ptr<SelectedRuns> runs;              ///< of one axis
};

/// Reads the selection's runs of one axis, and its voxels.
[[nodiscard]] Result<DecodedSelection> decode_selection(const std::shared_ptr<const Atlas>& atlas,
                                                        const Selection& selection, Axis axis,
                                                        ThreadPool& pool);

}  // namespace splatlas
