// Run-length encoding of the class volume, one model per principal axis, and means in blocks of its voxels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"

namespace splatlas {

/// Traversal order for one principal axis: slices normal to it, scanlines of a slice, voxels of a scanline.
/// Scanlines run along i if possible, for contiguous memory access:
///   principal z: slices k, scanlines j, along i
///   principal y: slices j, scanlines k, along i
///   principal x: slices i, scanlines k, along j
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

/// `length` voxels of one class from voxel `start` of scanline number `scanline` = slice * rows + row.
struct Run {
  std::uint64_t scanline = 0;
  std::uint32_t start = 0;
  std::uint32_t length = 0;
  friend auto operator<=>(const Run&, const Run&) = default;
};

/// All runs of one class in traversal order of one principal axis. Runs are maximal: none are adjacent.
using ClassRuns = std::vector<Run>;

/// Run model of one principal axis: one list of runs per class (WSCG 2004, section 3; see ClassId). The list
/// of class 0 (empty) has no runs. A selection merges the lists of its classes and accesses no other run.
struct RunModel {
  Axis axis = Axis::kZ;
  std::vector<ClassRuns> classes;

  friend bool operator==(const RunModel&, const RunModel&) = default;
  [[nodiscard]] std::uint64_t runs() const;
};

/// Run-length encodes a class volume (i fastest, `size` voxels, classes below `class_count`) in one pass.
[[nodiscard]] RunModel encode_runs(std::span<const ClassId> volume, const Index3& size, Axis axis,
                                   std::size_t class_count);

/// Decodes the class volume; `size` must be that of a valid grid. kInvalidAtlas for runs that are outside the
/// grid, out of order, empty, of class 0, or overlapping. Memory: one ClassId per voxel.
[[nodiscard]] Result<std::vector<ClassId>> decode_runs(const RunModel& model, const Index3& size);

/// Validates the runs of one class: in order, maximal, inside the (valid) grid, with `voxels` voxels in
/// total; else kInvalidAtlas. Safe with untrusted runs. Cost: linear in the runs.
[[nodiscard]] Result<void> validate_runs(std::span<const Run> runs, const Index3& size, Axis axis,
                                         std::uint64_t voxels);

/// Bounding box of the voxels of valid runs (see validate_runs()).
[[nodiscard]] IndexBox box_of(std::span<const Run> runs, const Index3& size, Axis axis);

/// Converts runs, which must pass validate_runs, to another principal axis. Linear in the runs if both axes
/// share scanlines (y and z), else in the voxels and the sides of their box. Memory: linear in the runs.
[[nodiscard]] ClassRuns convert_runs(std::span<const Run> runs, const Index3& size, Axis from, Axis to);

/// Blocks have 2^kMeanLevel voxels along each axis. Block (i, j, k) begins at voxel (4i, 4j, 4k); the grid of
/// blocks is coarse_grid(grid, kMeanLevel).
inline constexpr int kMeanLevel = 2;

/// The blocks with voxels of some classes, in memory order of the grid of blocks.
struct BlockMeans {
  ClassRuns runs;                    ///< of blocks, principal axis z
  std::vector<std::uint8_t> voxels;  ///< [block]: voxels of the classes, 1 to 64
  std::vector<std::byte> values;     ///< [block]: means, of the atlas's value type
};

}  // namespace splatlas
