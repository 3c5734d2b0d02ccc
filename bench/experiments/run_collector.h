// Draws of a selection by class, and collector that sorts their runs by scanline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/content/run_model.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

inline constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

/// Per class, the index of the plan entry that draws its volume, or kNotDrawn.
[[nodiscard]] std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes);

/// As draws_by_class(), but classes of equal appearance share their first entry: without boundary shading
/// they are one. `appearances` correspond to the classes of the plan.
[[nodiscard]] std::vector<std::uint32_t> shared_draws_by_class(const DrawPlan& plan,
                                                               std::span<const VolumeAppearance> appearances,
                                                               std::size_t classes);

/// Bounding box of the voxels that a plan draws as volume.
[[nodiscard]] IndexBox drawn_box(const DrawPlan& plan, const ClassTable& classes);

/// Adjacent voxels of one scanline with one draw.
struct FoundRun {
  std::uint32_t row = 0, start = 0, length = 0;
  std::uint32_t draw = 0;  ///< index into the classes of a plan
};

/// Runs sorted by slice, row and start, in grid indices.
struct FoundRuns {
  std::int64_t slice_first = 0;
  std::vector<std::uint32_t> first_run;  ///< per slice, and the end; empty without runs
  std::vector<FoundRun> runs;

  [[nodiscard]] std::span<const FoundRun> slice(std::int64_t n) const {
    const std::int64_t at = n - slice_first;
    if (at < 0 || at + 1 >= std::ssize(first_run)) return {};
    const std::uint32_t* const first = &first_run[static_cast<std::size_t>(at)];
    return {runs.data() + first[0], runs.data() + first[1]};
  }
};

/// Collects runs and sorts them by scanline, for models other than the run model.
class RunCollector {
 public:
  /// All runs must lie in `box`, in voxels of the grid.
  RunCollector(const IndexBox& box, Axis axis);

  [[nodiscard]] const ScanOrder& scan() const { return scan_; }

  /// `slice` and `row` are grid indices. Runs of different draws never overlap; those of one draw may.
  void add(std::int64_t slice, std::int64_t row, std::uint32_t start, std::uint32_t length,
           std::uint32_t draw) {
    const auto scanline = static_cast<std::uint32_t>((slice - slice_first_) * rows_ + row - row_first_);
    collected_.push_back({scanline, {static_cast<std::uint32_t>(row), start, length, draw}});
    ++first_run_[scanline + 1];
  }

  /// Adds every run of a list, for a grid of this size.
  void add_list(std::span<const Run> runs, const Index3& size, std::uint32_t draw) {
    const auto rows = static_cast<std::uint64_t>(size[scan_.row_axis]);
    for (const Run& run : runs) {
      add(static_cast<std::int64_t>(run.scanline / rows), static_cast<std::int64_t>(run.scanline % rows),
          run.start, run.length, draw);
    }
  }

  /// The runs by scanline and start, with touching or overlapping runs of one draw merged. Call once. Cost:
  /// linear in runs added in order; other scanlines are sorted.
  [[nodiscard]] FoundRuns finish();

 private:
  struct Collected {
    std::uint32_t scanline = 0;
    FoundRun run;
  };

  ScanOrder scan_;
  std::int64_t slice_first_ = 0, slices_ = 0, row_first_ = 0, rows_ = 0;  // of the box
  std::vector<std::uint32_t> first_run_;  // per scanline of the box, and the end
  std::vector<Collected> collected_;
};

}  // namespace splatlas
