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

  /// Computes the gradients of a row of a slice, both of the traversal. Cost: about 10 ns per voxel between
  /// the row's first and last selected voxel. The first row of a slice costs also the box of the selection's
  /// next slice, if slices follow each other, and of three slices otherwise.
  void set_row(std::int64_t slice, std::int64_t row);

  // Of a selected voxel of the row, by its position in the scanline.

  /// Grey values per voxel, along the scanline, the rows and the slices.
  [[nodiscard]] std::array<float, 3> gradient(std::int64_t scan) const {
    const auto n = static_cast<std::size_t>(scan - scan_first_);
    return {means_[0][n], means_[1][n], means_[2][n]};
  }
  /// Squared length, grey values per mm, and the weighted mean of the squared differences: at least as large,
  /// and equal on a ramp.
  [[nodiscard]] float length_squared(std::int64_t scan) const { return lengths_[place(scan)]; }
  [[nodiscard]] float mean_square(std::int64_t scan) const { return squares_[place(scan)]; }
  [[nodiscard]] float grey(std::int64_t scan) const {
    return planes_[1].values[static_cast<std::size_t>(row_ * width_) + 1 + place(scan)];
  }

 private:
  /// The voxels of a slice of the box, padded by one voxel.
  struct Plane {
    struct Extent {
      std::int64_t begin = 0, end = 0;  // padded positions of a row's selected voxels
    };
    std::int64_t slice = std::numeric_limits<std::int64_t>::min();
    std::vector<Extent> rows;
    std::vector<float> values, selected;  // 0 or 1; values are 0 where `selected` is
  };
  /// Weighted sums over pairs, by padded position.
  struct Sums {
    std::vector<float> differences, squares, pairs;
  };
  [[nodiscard]] std::size_t place(std::int64_t scan) const {
    return static_cast<std::size_t>(scan - scan_first_);
  }
  void set_slice(std::int64_t slice);
  void fill(std::int64_t slice, Plane& plane) const;
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
  std::int64_t row_ = 0, begin_ = 0, end_ = 0;  // padded: of the current row, and of its selected voxels
};

}  // namespace splatlas
