// Draws of a selection, as flat tables by class.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/decision_tree.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

inline constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

/// Per class, the index of the plan entry that draws its volume, or kNotDrawn.
[[nodiscard]] std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes);

/// As draws_by_class(), but classes of equal appearance share their first entry: without boundary shading
/// they are one. `appearances` correspond to the classes of the plan.
[[nodiscard]] std::vector<std::uint32_t> shared_draws_by_class(const DrawPlan& plan,
                                                               std::span<const VolumeAppearance> appearances,
                                                               std::size_t classes);

}  // namespace splatlas
