// Voxel grid geometry: size, spacing, origin and direction of a volume, and permutation of its axes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "format/result.h"

namespace splatlas {

using Index3 = std::array<std::int64_t, 3>;
using Vec3 = std::array<double, 3>;
using Matrix3 = std::array<double, 9>;  ///< row-major
[[nodiscard]] double determinant(const Matrix3& m);

/// Scalar product.
template <typename T>
[[nodiscard]] constexpr T dot(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// a - b
template <typename T>
[[nodiscard]] constexpr std::array<T, 3> difference(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Vector product.
template <typename T>
[[nodiscard]] constexpr std::array<T, 3> cross(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

enum class Axis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };
inline constexpr std::array<Axis, 3> kAxes{Axis::kX, Axis::kY, Axis::kZ};

/// Maximum number of voxels along one axis: sums of indices fit in 32 bits.
inline constexpr std::int64_t kMaxAxisSize = std::int64_t{1} << 24;
/// Maximum number of voxels of a grid (2^40): byte counts fit in 64 bits.
inline constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 40;

/// Limits of spacing and of coordinates (absolute value) in LPS mm. They exceed every scan, and keep products
/// in geometric computations from overflow and underflow.
inline constexpr double kMinSpacingMm = 1e-9, kMaxSpacingMm = 1e9, kMaxMm = 1e15;
/// Limits of the column lengths of a direction matrix; nominally 1.
inline constexpr double kMinColumnLength = 1e-3, kMaxColumnLength = 1e3;

/// True if all coordinates are at most kMaxMm from the origin.
[[nodiscard]] inline bool is_within_reach(const Vec3& position_lps_mm) {
  return std::ranges::all_of(position_lps_mm, [](double mm) { return std::abs(mm) <= kMaxMm; });
}

/// A regular grid of voxels in LPS mm, with ITK's convention: the centre of voxel (i, j, k) is
/// origin + direction * (i * spacing[0], j * spacing[1], k * spacing[2]).
struct Grid {
  Index3 size{0, 0, 0};                              ///< voxels along i, j, k
  Vec3 spacing_mm{1, 1, 1};                          ///< positive
  Vec3 origin_lps_mm{0, 0, 0};                       ///< centre of voxel (0, 0, 0)
  Matrix3 direction_lps{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< column a: direction of axis a; may be left-handed

  friend bool operator==(const Grid&, const Grid&) = default;

  [[nodiscard]] std::int64_t voxels() const { return size[0] * size[1] * size[2]; }
  /// Memory offset of voxel (i, j, k) in voxels: i varies fastest.
  [[nodiscard]] std::int64_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return (k * size[1] + j) * size[0] + i;
  }
  [[nodiscard]] bool contains(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
};

/// Volume of a voxel (mm^3), a parallelepiped if the axes are sheared. If the determinant of the direction is
/// 1 within the rounding of single precision, it is exactly the product of the spacings: it depends on no
/// rounding of a rotation.
[[nodiscard]] double voxel_volume_mm3(const Grid& grid);
/// Cube root of the volume of a voxel: the path length to which volume opacities refer.
[[nodiscard]] double reference_length_mm(const Grid& grid);

/// An affine map x -> linear * x + offset.
struct Affine {
  Matrix3 linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vec3 offset{0, 0, 0};

  [[nodiscard]] Vec3 apply(const Vec3& x) const;
  [[nodiscard]] Vec3 apply_linear(const Vec3& x) const;
};

/// Map from continuous voxel indices (i, j, k) to LPS mm.
[[nodiscard]] Affine index_to_lps_mm(const Grid& grid);
/// The least and the largest LPS mm of the voxels from `first` to `last`, from edge to edge.
[[nodiscard]] std::pair<Vec3, Vec3> box_lps_mm(const Grid& grid, const Index3& first, const Index3& last);
/// Map from LPS mm to continuous voxel indices. `grid` must be valid.
[[nodiscard]] Affine lps_mm_to_index(const Grid& grid);

/// kFailed if a size, spacing, coordinate of the origin or column length of the direction is outside its
/// limits or not finite, or if the direction is nearly singular. The message calls the grid `what`.
[[nodiscard]] Result<void> validate(const Grid& grid, const std::string& what);

/// A signed permutation of axes: new axis a is old axis `from[a]`, reversed if `flipped[a]`.
struct AxisOrder {
  std::array<std::uint8_t, 3> from{0, 1, 2};
  std::array<bool, 3> flipped{false, false, false};

  friend bool operator==(const AxisOrder&, const AxisOrder&) = default;
  [[nodiscard]] bool is_identity() const { return *this == AxisOrder{}; }
  /// True if every axis occurs once: a precondition of all functions that take an AxisOrder.
  [[nodiscard]] bool is_permutation() const {
    return from[0] < 3 && from[1] < 3 && from[2] < 3 && from[0] + from[1] + from[2] == 3 &&
           from[0] != from[1] && from[1] != from[2];
  }
};

/// Axis order of the storage grid: the signed permutation that aligns the axes best with +L, +P, +S. All 48
/// axis orders of one volume have the same storage grid. Ties go to the first permutation.
[[nodiscard]] AxisOrder storage_order(const Grid& source);
[[nodiscard]] AxisOrder inverse(const AxisOrder& order);
/// The grid with permuted axes. Exact except for the rounding of the origin.
[[nodiscard]] Grid reordered(const Grid& grid, const AxisOrder& order);

/// Copies a volume of `size` voxels of `bytes_per_voxel` bytes from `from` to `to` with permuted axes. Cost:
/// one tiled pass. The buffers must not overlap.
void reorder_voxels(const void* from, const Index3& size, const AxisOrder& order, std::size_t bytes_per_voxel,
                    void* to);

/// The grid of blocks of 2^level voxels along each axis. Blocks at the end may reach beyond `grid`.
[[nodiscard]] Grid coarse_grid(const Grid& grid, int level);

}  // namespace splatlas
