// Run models: for each principal axis, the runs of equal class along every scanline (paper, section 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/class_table.h"
#include "format/grid.h"

namespace splatlas {

/// How a volume is walked for one principal axis: slices normal to it, scanlines within a slice, voxels along
/// a scanline. Scanlines run along i where they can, so that values are contiguous in memory: principal z:
/// slices k, scanlines j, along i; principal y: slices j, scanlines k, along i; principal x: slices i,
/// scanlines k, along j.
struct ScanOrder {
  std::uint8_t slice_axis, row_axis, scan_axis;

  [[nodiscard]] static constexpr ScanOrder of(Axis principal) {
    switch (principal) {
      case Axis::kX: return {0, 2, 1};
      case Axis::kY: return {1, 2, 0};
      case Axis::kZ: break;
    }
    return {2, 1, 0};
  }
};

/// `length` voxels of one class, from `start` along scanline number `scanline` = slice * rows + row.
struct Run {
  std::uint64_t scanline = 0;
  std::uint32_t start = 0;
  std::uint32_t length = 0;
  friend auto operator<=>(const Run&, const Run&) = default;
};

/// Everything that one class covers, in traversal order of one principal axis. Runs are maximal: two runs of
/// a class never touch in a scanline.
using ClassRuns = std::vector<Run>;

/// The run model of one principal axis: one list per class; the list of class 0 (empty) is left out, it is
/// what remains. A selection merges the lists of its classes and never sees any other run.
struct RunModel {
  Axis axis = Axis::kZ;
  std::vector<ClassRuns> classes;

  friend bool operator==(const RunModel&, const RunModel&) = default;
  [[nodiscard]] std::uint64_t runs() const;
};

/// Cuts a class volume (i fastest, `size` voxels, classes below `class_count`) into runs. Pure; one pass.
[[nodiscard]] RunModel encode_runs(std::span<const ClassId> volume, const Index3& size, Axis axis,
                                   std::size_t class_count);

/// The class volume again; `size` must be that of a valid grid. Refuses (kInvalidAtlas) runs outside the
/// grid, out of order, empty, of class 0, or overlapping. Memory: one ClassId a voxel.
[[nodiscard]] Result<std::vector<ClassId>> decode_runs(const RunModel& model, const Index3& size);

/// Checks one class's list: in order, maximal, inside the (valid) grid, and `voxels` voxels in all; else
/// kInvalidAtlas. Safe with any numbers in the runs. Cost: linear in the runs.
[[nodiscard]] Result<void> validate_runs(std::span<const Run> runs, const Index3& size, Axis axis,
                                         std::uint64_t voxels);

/// The same voxels as runs of another principal axis. `runs` must pass validate_runs. Cost: linear in the
/// runs when both axes share scanlines (y and z), else in the voxels covered and the sides of their box;
/// memory: of the runs.
[[nodiscard]] ClassRuns convert_runs(std::span<const Run> runs, const Index3& size, Axis from, Axis to);

}  // namespace splatlas
