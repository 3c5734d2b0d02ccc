// The gradient of a structure's mask after Gaussian smoothing: where normals come from.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/derive/structure_crop.h"

namespace splatlas {

/// Convolves a crop with the derivatives of a Gaussian whose sigma is one voxel along every axis. In index
/// space that is isotropic; turned into mm by the grid's inverse transpose it is the gradient of a mask
/// smoothed as coarsely as the voxels are, which keeps planes' normals exact whatever the spacing. Slices are
/// filtered along i and j one after the other, seven of them are kept; along k where somebody asks. Memory:
/// that of 21 slices of the crop. Cost: 5 passes of 7 taps a voxel in rows near the structure, vectorised.
class SmoothGradient {
 public:
  /// `crop` must outlive this.
  explicit SmoothGradient(const StructureCrop& crop);
  SmoothGradient(const SmoothGradient&) = delete;  // its planes are named by where they are
  SmoothGradient& operator=(const SmoothGradient&) = delete;

  /// Makes the next slice's gradients (k = 0 first) and lets the accessors show them.
  void next_slice();

  /// Gradient at (i, j) of the current slice, per voxel along i, j, k. Cost: 21 taps.
  [[nodiscard]] std::array<float, 3> at(std::int64_t i, std::int64_t j) const {
    const auto n = static_cast<std::size_t>(j * crop_.size[0] + i);
    std::array<float, 3> gradient{0, 0, 0};
    for (std::size_t t = 0; t < kTaps; ++t) {
      gradient[0] += gauss_[t] * planes_[t]->along_i[n];
      gradient[1] += gauss_[t] * planes_[t]->along_j[n];
      gradient[2] += derivative_[t] * planes_[t]->smooth[n];
    }
    return gradient;
  }

  /// How far away voxels still count, along every axis.
  static constexpr std::int64_t kRadius = 3;

 private:
  static constexpr std::int64_t kTaps = 2 * kRadius + 1;
  using Kernel = std::array<float, kTaps>;
  /// One slice after the passes along i and j: smoothed, d/dj and d/di of smoothed.
  struct Plane {
    std::vector<float> smooth, along_j, along_i;
  };

  void filter_plane(std::int64_t k);
  void filter_row(std::int64_t j, std::int64_t k);

  const StructureCrop& crop_;
  Kernel gauss_{}, derivative_{};
  std::int64_t next_ = 0;                          // slice that next_slice() makes
  std::int64_t planes_made_ = 0;                   // planes below this number are or were in the ring
  std::vector<float> row_;                         // one row of the mask with zeros at both ends
  std::vector<float> rows_smooth_, rows_derived_;  // the slice after the pass along i, zero rows at both ends
  std::array<Plane, kTaps> ring_;
  std::array<const Plane*, kTaps> planes_{};  // of the current slice and those around it
  std::vector<std::uint8_t> row_holds_;       // whether the structure holds voxels of the row; rows as above
};

}  // namespace splatlas
