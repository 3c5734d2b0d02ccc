#include "format/codec/fit_weights.h"

#include <algorithm>
#include <cmath>

namespace splatlas {

void WeightFit::add(const std::array<float, kSize>& from_before, float value, float weight) {
  ++voxels_;
  for (std::size_t a = 0; a < kSize; ++a) {
    const float weighted = weight * from_before[a];
    right_side_[a] += weighted * value;
    for (std::size_t b = 0; b <= a; ++b) products_[a][b] += weighted * from_before[b];
  }
}

ValueWeights WeightFit::weights() const {
  constexpr std::uint64_t kMinVoxels = 300;
  if (voxels_ < kMinVoxels) return kMeanWeights;
  // Cholesky decomposition of the normal matrix, regularized on the diagonal (Tikhonov).
  std::array<std::array<double, kSize>, kSize> lower{};
  std::array<double, kSize> solved{};
  for (std::size_t a = 0; a < kSize; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double left = products_[a][b] + (a == b ? 1e-3 + 1e-6 * products_[a][a] : 0);
      for (std::size_t c = 0; c < b; ++c) left -= lower[a][c] * lower[b][c];
      lower[a][b] = a == b ? std::sqrt(std::max(left, 1e-9)) : left / lower[b][b];
    }
    solved[a] = right_side_[a];
    for (std::size_t c = 0; c < a; ++c) solved[a] -= lower[a][c] * solved[c];
    solved[a] /= lower[a][a];
  }
  ValueWeights weights{};
  for (std::size_t a = kSize; a-- > 0;) {
    for (std::size_t c = a + 1; c < kSize; ++c) solved[a] -= lower[c][a] * solved[c];
    solved[a] /= lower[a][a];
    weights[a] = static_cast<std::int8_t>(std::lround(std::clamp(solved[a] * kWeightUnit, -128.0, 127.0)));
  }
  return weights;
}

}  // namespace splatlas
