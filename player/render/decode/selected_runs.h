// Runs of the selected classes: a filtered view of the runs of all decoded classes.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/decision_tree.h"
#include "player/render/decode/class_cache.h"

namespace splatlas {

/// Runs of the volume and hybrid classes of a plan for one principal axis, by scanline. Stores no runs.
/// Traversal filters the decoded runs within the slices and rows of the selection's bounding box; runs
/// outside the box and classes that are not decoded cost no time.
class SelectedRuns {
 public:
  static constexpr std::uint32_t kNotDrawn = std::numeric_limits<std::uint32_t>::max();

  /// `cache` must outlive this and hold the plan's volume classes along `axis`. Cost: linear in the classes.
  SelectedRuns(const DrawPlan& plan, const ClassTable& classes, const ClassCache& cache, Axis axis);

  [[nodiscard]] Axis axis() const { return axis_; }
  /// Union of the selected classes' bounding boxes, in scan order: x along the scanline, y rows, z slices.
  [[nodiscard]] const IndexBox& box() const { return box_; }
  [[nodiscard]] std::int64_t slices() const { return box_.last[2] - box_.first[2] + 1; }
  [[nodiscard]] std::int64_t rows() const { return box_.last[1] - box_.first[1] + 1; }
  [[nodiscard]] std::int64_t scan_voxels() const { return box_.last[0] - box_.first[0] + 1; }
  /// Number of runs of the selected classes.
  [[nodiscard]] std::uint64_t count() const { return count_; }

  /// Index into the plan's classes, or kNotDrawn.
  [[nodiscard]] std::uint32_t draw_of(ClassId c) const { return draw_of_class_[c]; }

  /// Calls take(run, index into the plan's classes) for the runs of a slice of the grid, in order.
  template <typename Take>
  void for_each(std::int64_t slice, const Take& take) const {
    for_each(slice, box_.first[1], box_.last[1] + 1, take);
  }
  /// The same for rows [first_row, last_row) of the slice.
  template <typename Take>
  void for_each(std::int64_t slice, std::int64_t first_row, std::int64_t last_row, const Take& take) const {
    for (const ClassRun& run : decoded(slice, first_row, last_row)) {
      if (const std::uint32_t draw = draw_of_class_[run.id]; draw != kNotDrawn) take(run, draw);
    }
  }
  /// The same for all slices.
  template <typename Take>
  void for_each(const Take& take) const {
    for (const std::int64_t slice : occupied()) for_each(slice, take);
  }
  /// Numbers of the slices with runs of decoded classes in the box, ascending.
  [[nodiscard]] std::span<const std::int64_t> occupied() const {
    return runs_.occupied(box_.first[2], box_.last[2]);
  }
  /// The run of a selected class that contains a voxel, given by slice, row and position along the scanline;
  /// null if there is none. The position may be outside the grid.
  [[nodiscard]] const ClassRun* at(std::int64_t slice, std::int64_t row, std::int64_t scan) const;

 private:
  /// Runs of decoded classes in rows [first_row, last_row) of a slice.
  [[nodiscard]] std::span<const ClassRun> decoded(std::int64_t slice, std::int64_t first_row,
                                                  std::int64_t last_row) const;

  Axis axis_;
  const ScanlineRuns& runs_;
  IndexBox box_;
  std::uint64_t count_ = 0;
  std::vector<std::uint32_t> draw_of_class_;
};

}  // namespace splatlas
