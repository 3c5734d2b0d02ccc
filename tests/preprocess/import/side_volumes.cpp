#include "tests/preprocess/import/side_volumes.h"

namespace splatlas {

Vec3 Body::position(const Index3& index) const {
  Vec3 at = origin_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t row = 0; row < 3; ++row)
      at[row] += axes_lps[a][row] * spacing_mm[a] * static_cast<double>(index[a]);
  }
  return at;
}

std::uint8_t Body::mark(const Index3& index) const {
  const auto [l, p, s] = index;
  if (l == size[0] - 1 && (p == 1 || p == 2) && s == 1) return 1;
  if (p == 0 && l >= 1 && l <= 3 && s <= 1) return 2;
  if (s == size[2] - 1 && l == 1 && p >= 2) return 3;
  return 0;
}

Vec3 Body::centroid(std::uint8_t wanted) const {
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (std::int64_t s = 0; s < size[2]; ++s) {
    for (std::int64_t p = 0; p < size[1]; ++p) {
      for (std::int64_t l = 0; l < size[0]; ++l) {
        if (mark({l, p, s}) != wanted) continue;
        const Vec3 at = position({l, p, s});
        for (std::size_t a = 0; a < 3; ++a) sum[a] += at[a];
        ++count;
      }
    }
  }
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

std::array<Vec3, 3> oblique_axes() {
  // Columns of the rotation of the unit quaternion (8 + i + 2 j + 3 k) / sqrt(78): less than 45 degrees.
  return {Vec3{52. / 78, 52. / 78, -26. / 78}, Vec3{-44. / 78, 58. / 78, 28. / 78},
          Vec3{38. / 78, -4. / 78, 68. / 78}};
}

PlacedVolume placed(const Body& body, const AxisOrder& order) {
  PlacedVolume volume{};
  Index3 first{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t from = order.from[a];
    volume.size[a] = body.size[from];
    volume.spacing_mm[a] = body.spacing_mm[from];
    const double sign = order.flipped[a] ? -1 : 1;
    for (std::size_t row = 0; row < 3; ++row) volume.axes_lps[a][row] = sign * body.axes_lps[from][row];
    if (order.flipped[a]) first[from] = body.size[from] - 1;
  }
  volume.first_lps_mm = body.position(first);
  for (std::int64_t k = 0; k < volume.size[2]; ++k) {
    for (std::int64_t j = 0; j < volume.size[1]; ++j) {
      for (std::int64_t i = 0; i < volume.size[0]; ++i) {
        Index3 index = first;
        const Index3 steps{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) index[order.from[a]] += (order.flipped[a] ? -1 : 1) * steps[a];
        volume.values.push_back(body.mark(index));
      }
    }
  }
  return volume;
}

}  // namespace splatlas
