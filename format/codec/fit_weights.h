// Weights of neighbours fitted to the grey values of a group.
#pragma once

#include <array>
#include <cstdint>

#include "format/codec/value_filter.h"

namespace splatlas {

/// What Colin 27 has in the mean, for groups too small to fit.
inline constexpr ValueWeights kMeanWeights{36, 37, 6, -15, -15, -12, 2, 5, -4, 4, -2, 1, -5, -6};

/// Weighted least squares over voxels, as differences from the voxel before.
class WeightFit {
 public:
  /// `from_before`: the neighbours' values less that of the voxel before, 0 for absent ones; `value`: the
  /// voxel's, likewise; `weight`: how much it counts.
  void add(const std::array<float, kNeighbours.size()>& from_before, float value, float weight);
  /// kMeanWeights for less than a few hundred voxels.
  [[nodiscard]] ValueWeights weights() const;

 private:
  static constexpr std::size_t kSize = kNeighbours.size();
  std::array<std::array<double, kSize>, kSize> products_{};  // of neighbours; the lower triangle
  std::array<double, kSize> towards_{};                      // of neighbours and values
  std::uint64_t voxels_ = 0;
};

}  // namespace splatlas
