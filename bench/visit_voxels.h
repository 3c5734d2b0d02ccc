// Finds the selected voxels of one frame by looking at all of them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "bench/voxel_model.h"
#include "format/decision_tree.h"
#include "format/system/thread_pool.h"
#include "player/spans/span_model.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// What the visit knows of a selection: per class, which entry of the plan draws its volume.
struct VoxelSelection {
  static constexpr std::uint32_t kNotDrawn = std::numeric_limits<std::uint32_t>::max();

  std::span<const std::uint32_t> draw_of_class;  ///< index into plan.classes, or kNotDrawn
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< of plan.classes
  const ClassTable& classes;
};

/// The spans that the player builds from the run model, made by testing the class of every voxel of the grid,
/// slice by slice and scanline by scanline; light is looked up for selected voxels only. The same numbers as
/// the player's, bit for bit. Cost: all voxels, plus the selected ones; slices are visited in parallel.
[[nodiscard]] SpanModel visit_voxels(const VoxelModel& model, const VoxelSelection& selection, Axis axis,
                                     ThreadPool& pool);

}  // namespace splatlas
