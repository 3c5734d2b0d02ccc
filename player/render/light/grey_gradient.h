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

namespace splatlas {

/// Gradients of grey values, from selected voxels alone (docs/model.md, "Hybrid shading"): along each axis of
/// the grid the weighted mean of the differences of all pairs of adjacent selected voxels in the block of
/// 3x3x3 around a voxel. Linear ramps thus have exact gradients, also at the selection's border. Not
/// thread-safe.
class GreyGradient {
 public:
  /// Arguments must outlive this object. The atlas must have values.
  GreyGradient(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid);

  /// Computes the gradients of a row of a slice, both of the traversal. Cost: about 10 ns per selected voxel
  /// and voxel of small gaps. Following slices share what they have read.
  void set_row(std::int64_t slice, std::int64_t row);

  // Of the selected voxels of the row, from position `scan` in the scanline on.

  /// Gradient along the scanline (0), the rows (1) or the slices (2), grey values per voxel.
  [[nodiscard]] const float* gradient(std::size_t axis, std::int64_t scan) const {
    return means_[axis].data() + (scan - scan_first_);
  }
  /// Squared length, grey values per mm, and the weighted mean of the squared differences: at least as large,
  /// and equal on a ramp.
  [[nodiscard]] const float* lengths_squared(std::int64_t scan) const {
    return lengths_.data() + (scan - scan_first_);
  }
  [[nodiscard]] const float* mean_squares(std::int64_t scan) const {
    return squares_.data() + (scan - scan_first_);
  }
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
  /// Weighted sums over pairs, by padded position.
  struct Sums {
    std::vector<float> differences, squares, pairs;
  };
  void set_slice(std::int64_t slice);
  void fill(std::int64_t slice, Plane& plane) const;
  void measure(const Segment& segment);
  void add_pairs(const Plane& low, const Plane& high, std::int64_t low_row, std::int64_t high_row,
                 std::int64_t ahead, float weight);
  void finish(std::size_t axis, const std::array<float, 3>& weights);

  const SelectedRuns& runs_;
  const ClassCache& cache_;
  std::array<std::size_t, 3> step_{};      // in memory, along the scanline, the rows and the slices
  std::array<float, 3> per_mm_squared_{};  // along them
  std::int64_t scan_first_, row_first_, width_, height_;
  std::array<Plane, 3> planes_;  // before, at and after the slice
  Sums sums_;
  std::array<std::vector<float>, 3> means_;
  std::vector<float> lengths_, squares_;
  std::int64_t row_ = 0, begin_ = 0, end_ = 0;  // padded: the current row and segment
};

}  // namespace splatlas
