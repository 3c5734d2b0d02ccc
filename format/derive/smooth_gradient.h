// Gradient of a structure's Gaussian-smoothed mask.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/derive/structure_crop.h"

namespace splatlas {

/// Filters of a Gaussian with a sigma of one voxel, cut at three voxels: the Gaussian, with sum 1, and its
/// derivative, which is 1 on a ramp of slope 1.
struct GradientKernels {
  static constexpr std::int64_t kRadius = 3;
  static constexpr std::int64_t kTaps = 2 * kRadius + 1;
  using Kernel = std::array<float, kTaps>;

  Kernel gauss{}, derivative{};
  GradientKernels();
};

/// Convolves a crop with the derivatives of a Gaussian with a sigma of one voxel along every axis. The filter
/// is isotropic in index space; the inverse transpose of the grid's matrix transforms gradients to mm. The
/// normals of planes are thus exact for any spacing. Slices are filtered along i and j in sequence, into a
/// ring of seven; at() filters along k. Memory: 21 slices of floats. Cost: 5 passes of 7 taps per voxel in
/// rows near the structure.
class SmoothGradient {
 public:
  /// `crop` must outlive this.
  explicit SmoothGradient(const StructureCrop& crop);
  SmoothGradient(const SmoothGradient&) = delete;  // planes_ points into ring_
  SmoothGradient& operator=(const SmoothGradient&) = delete;

  /// Advances to the next slice, first to k = 0.
  void next_slice();

  /// Gradient at (i, j) of the current slice, per voxel along i, j, k. Cost: 21 taps.
  [[nodiscard]] std::array<float, 3> at(std::int64_t i, std::int64_t j) const {
    const auto n = static_cast<std::size_t>(j * crop_.size[0] + i);
    std::array<float, 3> gradient{0, 0, 0};
    for (std::size_t t = 0; t < kTaps; ++t) {
      gradient[0] += kernels_.gauss[t] * planes_[t]->along_i[n];
      gradient[1] += kernels_.gauss[t] * planes_[t]->along_j[n];
      gradient[2] += kernels_.derivative[t] * planes_[t]->smooth[n];
    }
    return gradient;
  }

  /// Filter radius in voxels along every axis.
  static constexpr std::int64_t kRadius = GradientKernels::kRadius;

 private:
  static constexpr std::int64_t kTaps = GradientKernels::kTaps;
  /// One slice after the passes along i and j: smoothed mask and its derivatives d/dj and d/di.
  struct Plane {
    std::vector<float> smooth, along_j, along_i;
  };

  void filter_plane(std::int64_t k);
  void filter_row(std::int64_t j, std::int64_t k);

  const StructureCrop& crop_;
  const GradientKernels kernels_;
  std::int64_t next_ = 0;         // next slice
  std::int64_t planes_made_ = 0;  // number of planes filtered so far
  std::vector<float> row_;        // one row of the mask, zero-padded
  std::vector<float> rows_smooth_,
      rows_derived_;  // the slice after the pass along i, with zero rows as padding
  std::array<Plane, kTaps> ring_;
  std::array<const Plane*, kTaps> planes_{};  // the current slice and its neighbours
  std::vector<std::uint8_t> row_occupied_;    // 1 for rows (padded as above) with voxels of the structure
};

}  // namespace splatlas
