// Which voxels a selection draws, and how, as flat tables by class.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/decision_tree.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

inline constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

/// Per class, which entry of the plan draws its volume, or kNotDrawn.
[[nodiscard]] std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes);

/// The same, but classes that look the same share the first entry of them: to whoever does not shade
/// boundaries they are one. `looks` and the plan's classes correspond.
[[nodiscard]] std::vector<std::uint32_t> shared_draws_by_class(const DrawPlan& plan,
                                                               std::span<const VolumeAppearance> appearances,
                                                               std::size_t classes);

}  // namespace splatlas
