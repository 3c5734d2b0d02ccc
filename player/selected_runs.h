// The runs of the selected classes, brought together scanline by scanline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/decision_tree.h"
#include "player/class_cache.h"

namespace splatlas {

/// One run of a selected class in its scanline.
struct SelectedRun {
  std::uint32_t start = 0, length = 0;
  std::uint32_t draw = 0;  ///< index into the plan's classes
};

/// Runs of the volume and hybrid classes of a plan for one principal axis, by scanline. Covers only the
/// slices and rows of the selection's box: nothing outside it costs time or memory.
struct SelectedRuns {
  Axis axis = Axis::kZ;
  std::int64_t slice_first = 0, slices = 0;
  std::int64_t row_first = 0, rows = 0;
  std::int64_t scan_first = 0, scan_voxels = 0;
  std::vector<std::uint32_t> first_run;  ///< slices * rows + 1 offsets into `runs`
  std::vector<SelectedRun> runs;         ///< by scanline, then start

  /// Slice and row are numbers of the grid, inside the box.
  [[nodiscard]] std::span<const SelectedRun> scanline(std::int64_t slice, std::int64_t row) const {
    const auto n = static_cast<std::size_t>((slice - slice_first) * rows + (row - row_first));
    return std::span(runs).subspan(first_run[n], first_run[n + 1] - first_run[n]);
  }
};

/// Whether a class of the plan contributes to the volume.
[[nodiscard]] constexpr bool draws_volume(VoxelRole role) {
  return role == VoxelRole::kVolume || role == VoxelRole::kHybrid;
}

/// Merges the class lists. Every run of the selected classes is visited twice (count, place), no other run
/// ever. The classes' runs of `axis` must have been required. kLimit above 2^32 - 1 runs.
[[nodiscard]] Result<SelectedRuns> merge_runs(const DrawPlan& plan, const Atlas& atlas,
                                              const ClassCache& cache, Axis axis);

}  // namespace splatlas
