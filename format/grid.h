// Where voxels are: size, spacing, origin and direction of a volume, and reordering of its axes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "format/result.h"

namespace splatlas {

using Index3 = std::array<std::int64_t, 3>;
using Vec3 = std::array<double, 3>;
using Matrix3 = std::array<double, 9>;  ///< row-major

enum class Axis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };
inline constexpr std::array<Axis, 3> kAxes{Axis::kX, Axis::kY, Axis::kZ};

/// Largest number of voxels along one axis: indices fit 32 bits with room for sums.
inline constexpr std::int64_t kMaxAxisSize = std::int64_t{1} << 24;
/// Largest number of voxels of a grid (2^40); far below what 64-bit byte counts can hold.
inline constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 40;

/// Spacings of a valid grid are from the first to the second, places at most kMaxMm from LPS's origin
/// along each axis: more than is ever scanned, and no product of the few that geometry multiplies overflows
/// or vanishes.
inline constexpr double kMinSpacingMm = 1e-9, kMaxSpacingMm = 1e9, kMaxMm = 1e15;
/// Columns of a grid's direction, whose length should be 1.
inline constexpr double kMinColumnLength = 1e-3, kMaxColumnLength = 1e3;

[[nodiscard]] inline bool is_within_reach(const Vec3& place_lps_mm) {
  return std::ranges::all_of(place_lps_mm, [](double mm) { return std::abs(mm) <= kMaxMm; });
}

/// A regular grid of voxels in LPS millimetres, as ITK has it: voxel (i, j, k) is centred at
/// origin + direction * (i * spacing[0], j * spacing[1], k * spacing[2]).
struct Grid {
  Index3 size{0, 0, 0};                              ///< voxels along i, j, k
  Vec3 spacing_mm{1, 1, 1};                          ///< positive
  Vec3 origin_lps_mm{0, 0, 0};                       ///< centre of voxel (0, 0, 0)
  Matrix3 direction_lps{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< column a: where axis a points; may mirror

  friend bool operator==(const Grid&, const Grid&) = default;

  [[nodiscard]] std::int64_t voxels() const { return size[0] * size[1] * size[2]; }
  /// Position in memory of voxel (i, j, k): i runs fastest.
  [[nodiscard]] std::int64_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (k * size[1] + j) * size[0] + i;
  }
  [[nodiscard]] bool contains(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
};

/// Cube root of a voxel's volume: the length that opacities of volumes are of.
[[nodiscard]] double reference_length_mm(const Grid& grid);

/// An affine map x -> linear * x + offset.
struct Affine {
  Matrix3 linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vec3 offset{0, 0, 0};

  [[nodiscard]] Vec3 apply(const Vec3& x) const;
  [[nodiscard]] Vec3 apply_linear(const Vec3& x) const;
};

/// Continuous voxel indices (i, j, k) to LPS mm.
[[nodiscard]] Affine index_to_lps_mm(const Grid& grid);
/// LPS mm to continuous voxel indices. `grid` must be valid.
[[nodiscard]] Affine lps_mm_to_index(const Grid& grid);

/// Refuses sizes below 1 or above the limits, spacings that are not finite and positive, origins that are not
/// finite, and directions that are not finite or are (nearly) singular. `what` names the grid in the message.
[[nodiscard]] Result<void> validate(const Grid& grid, const std::string& what);

/// A signed permutation of axes: new axis a is old axis `from[a]`, reversed where `flipped[a]`.
struct AxisOrder {
  std::array<std::uint8_t, 3> from{0, 1, 2};
  std::array<bool, 3> flipped{false, false, false};

  friend bool operator==(const AxisOrder&, const AxisOrder&) = default;
  [[nodiscard]] bool is_identity() const { return *this == AxisOrder{}; }
  /// Whether every axis occurs once. Everything that takes an order takes this for granted.
  [[nodiscard]] bool is_permutation() const {
    return from[0] < 3 && from[1] < 3 && from[2] < 3 && from[0] + from[1] + from[2] == 3 &&
           from[0] != from[1] && from[1] != from[2];
  }
};

/// The order in which an atlas stores a source grid: the signed permutation whose axes run closest to
/// +L, +P, +S. All 48 axis orders of one volume are stored alike. Ties go to the first permutation.
[[nodiscard]] AxisOrder storage_order(const Grid& source);
[[nodiscard]] AxisOrder inverse(const AxisOrder& order);
/// The same voxels in the new order of axes. Exact but for the origin, which is computed in double.
[[nodiscard]] Grid reordered(const Grid& grid, const AxisOrder& order);

/// Copies voxels of `bytes_per_voxel` bytes from `from` (a volume of `size`) to `to` in the new order of
/// axes. Cost: one pass, in tiles. Buffers must not overlap.
void reorder_voxels(const void* from, const Index3& size, const AxisOrder& order, std::size_t bytes_per_voxel,
                    void* to);

}  // namespace splatlas
