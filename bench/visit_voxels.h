// Brute-force search for the selected voxels of a frame.
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

/// Selection in the form of the visit.
struct VoxelSelection {
  static constexpr std::uint32_t kNotDrawn = std::numeric_limits<std::uint32_t>::max();

  std::span<const std::uint32_t> draw_of_class;  ///< index into plan.classes, or kNotDrawn
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< per class of plan
  const ClassTable& classes;
};

/// The spans of the player, built by testing the class of every voxel of the grid, slice by slice and
/// scanline by scanline; optical properties are looked up for selected voxels only. Equal to those of the
/// player bit for bit. Cost: all voxels, plus the selected ones; slices run in parallel.
[[nodiscard]] SpanModel visit_voxels(const VoxelModel& model, const VoxelSelection& selection, Axis axis,
                                     ThreadPool& pool);

}  // namespace splatlas
