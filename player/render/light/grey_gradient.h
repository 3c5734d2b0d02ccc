// Gradient of the grey values of a selection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/content/grid.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/light/light_kernels.h"

namespace splatlas {

/// Gradients of grey values, from selected voxels alone (docs/model.md, "Hybrid shading"): along each axis of
/// the grid the weighted mean of the differences of all pairs of adjacent selected voxels in the block of
/// 3x3x3 around a voxel. Exact for linear ramps, also at the selection's border. Not thread-safe.
class GreyGradient {
 public:
  /// `runs` and `cache` must outlive this object. The atlas must have values.
  GreyGradient(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid,
               const GradientScale& scale);

  /// Computes the gradients of a row of a slice, both of the traversal. Cost: about 10 ns per selected voxel
  /// and voxel of small gaps. Following slices share what they have read.
  void set_row(std::int64_t slice, std::int64_t row);

  /// Those of the selected voxels of the row, from position `scan` in the scanline on.
  [[nodiscard]] GradientRow at(std::int64_t scan) { return row_from(scan - scan_first_); }
  /// Their grey values.
  [[nodiscard]] const float* greys(std::int64_t scan) const {
    return planes_[1].values.data() + row_ * width_ + 1 + (scan - scan_first_);
  }

 private:
  /// Padded positions [begin, end) of selected voxels with small gaps.
  struct Segment {
    std::int64_t begin = 0, end = 0;
  };
  /// The voxels of a slice of the box, padded by one voxel.
  struct Plane {
    std::int64_t slice = std::numeric_limits<std::int64_t>::min();
    std::vector<Segment> segments;           // by row
    std::vector<std::size_t> first_segment;  // of each row, and their number
    std::vector<float> values, selected;     // 0 or 1; values are 0 where `selected` is
  };
  void set_slice(std::int64_t slice);
  void fill(std::int64_t slice, Plane& plane) const;
  void measure(const Segment& segment);
  [[nodiscard]] GradientRow row_from(std::int64_t voxel) {
    const auto from = [voxel](std::vector<float>& row) { return row.data() + voxel; };
    return {{from(direction_[0]), from(direction_[1]), from(direction_[2])}, from(coherence_), from(reach_)};
  }

  const SelectedRuns& runs_;
  const ClassCache& cache_;
  std::array<std::size_t, 3> step_{};  // in memory, along the scanline, the rows and the slices
  GradientScale scale_;
  std::int64_t scan_first_, row_first_, width_, height_;
  std::array<Plane, 3> planes_;             // before, at and after the slice
  std::array<std::vector<float>, 9> sums_;  // three of each axis
  std::array<std::vector<float>, 3> direction_;
  std::vector<float> coherence_, reach_;
  std::int64_t row_ = 0;  // padded
};

}  // namespace splatlas
