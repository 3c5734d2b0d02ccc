// Least-squares fit of prediction weights to the grey values of a group.
#pragma once

#include <array>
#include <cstdint>

#include "format/codec/value_filter.h"

namespace splatlas {

/// Mean weights of the Colin 27 brain, for groups too small to fit.
inline constexpr ValueWeights kMeanWeights{36, 37, 6, -15, -15, -12, 2, 5, -4, 4, -2, 1, -5, -6};

/// Weighted linear least squares over voxels. All values are relative to the previous voxel.
class WeightFit {
 public:
  /// Adds a voxel. `from_before`: values of its neighbours, 0 for absent ones; `value`: its own; `weight`:
  /// its weight in the fit.
  void add(const std::array<float, kNeighbours.size()>& from_before, float value, float weight);
  /// The solution; kMeanWeights for fewer than a few hundred voxels.
  [[nodiscard]] ValueWeights weights() const;

 private:
  static constexpr std::size_t kSize = kNeighbours.size();
  std::array<std::array<double, kSize>, kSize> products_{};  // normal matrix, lower triangle
  std::array<double, kSize> right_side_{};                   // of the normal equations
  std::uint64_t voxels_ = 0;
};

}  // namespace splatlas
