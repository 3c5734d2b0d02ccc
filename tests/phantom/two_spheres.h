// Golden phantom: two voxelised balls in 32x32x32 voxels (paper, section 4, table 1), in closed form.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace splatlas::phantom {

inline constexpr int kSize = 32;  ///< voxels along each axis, 1 mm apart
inline constexpr std::size_t kVoxels = std::size_t{kSize} * kSize * kSize;

/// Voxels nearer to the centre than `radius`, and the six poles at exactly `radius` along an axis.
struct Ball {
  std::string_view name;
  std::array<int, 3> center;
  int radius;
  std::uint8_t label;

  [[nodiscard]] constexpr int squared_distance(int i, int j, int k) const {
    const int x = i - center[0], y = j - center[1], z = k - center[2];
    return x * x + y * y + z * z;
  }
  [[nodiscard]] constexpr bool holds(int i, int j, int k) const {
    const int d2 = squared_distance(i, j, k);
    const int on_axes = (i == center[0]) + (j == center[1]) + (k == center[2]);
    return d2 < radius * radius || (d2 == radius * radius && on_axes == 2);
  }
};

/// Disjoint, not adjacent, and clear of the border of the grid.
inline constexpr std::array<Ball, 2> kBalls{
    Ball{"Sphere 1", {11, 11, 11}, 10, 1},
    Ball{"Sphere 2", {23, 23, 23}, 6, 2},
};

/// Table 1 of the paper, for a ball. A voxel is boundary if one of its 18 neighbours is outside.
struct Description {
  std::uint64_t interior, boundary, triangles;
};
inline constexpr std::array<Description, 2> kTable1{Description{2705, 1440, 3704},
                                                    Description{437, 464, 1352}};
inline constexpr std::uint64_t kEmptyVoxels = 27722;

/// The label at a voxel; 0 outside both balls.
[[nodiscard]] constexpr std::uint8_t label_at(int i, int j, int k) {
  for (const Ball& ball : kBalls) {
    if (ball.holds(i, j, k)) return ball.label;
  }
  return 0;
}

/// Grey value of a voxel: 250 at a ball's centre, falling with the squared distance to 100 at its edge; or 0.
[[nodiscard]] constexpr std::uint8_t value_at(int i, int j, int k) {
  for (const Ball& ball : kBalls) {
    if (ball.holds(i, j, k)) {
      return static_cast<std::uint8_t>(250 -
                                       150 * ball.squared_distance(i, j, k) / (ball.radius * ball.radius));
    }
  }
  return 0;
}

/// `voxel_at(i, j, k)` for every voxel, i fastest.
template <typename VoxelAt>
[[nodiscard]] std::vector<std::uint8_t> fill_volume(VoxelAt voxel_at) {
  std::vector<std::uint8_t> volume;
  volume.reserve(kVoxels);
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) volume.push_back(voxel_at(i, j, k));
    }
  }
  return volume;
}

[[nodiscard]] inline std::vector<std::uint8_t> labels() {
  return fill_volume(label_at);
}
[[nodiscard]] inline std::vector<std::uint8_t> values() {
  return fill_volume(value_at);
}

}  // namespace splatlas::phantom
