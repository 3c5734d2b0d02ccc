#include "format/content/grid.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Minimum determinant of a direction with normalized columns; below, its inverse is inaccurate.
constexpr double kMinDeterminant = 1e-6;

/// Deviation of the determinant of orthonormal axes from 1 whose cosines were rounded to single precision.
constexpr double kRoundingOfDeterminant = 1e-6;

Matrix3 inverted(const Matrix3& m) {
  const double d = determinant(m);
  return {(m[4] * m[8] - m[5] * m[7]) / d, (m[2] * m[7] - m[1] * m[8]) / d, (m[1] * m[5] - m[2] * m[4]) / d,
          (m[5] * m[6] - m[3] * m[8]) / d, (m[0] * m[8] - m[2] * m[6]) / d, (m[2] * m[3] - m[0] * m[5]) / d,
          (m[3] * m[7] - m[4] * m[6]) / d, (m[1] * m[6] - m[0] * m[7]) / d, (m[0] * m[4] - m[1] * m[3]) / d};
}

double column_length(const Matrix3& m, std::size_t column) {
  return std::hypot(m[column], m[3 + column], m[6 + column]);
}

Matrix3 normalized_columns(Matrix3 m) {
  for (std::size_t column = 0; column < 3; ++column) {
    const double length = column_length(m, column);
    for (std::size_t row = 0; row < 3; ++row) m[3 * row + column] /= length;
  }
  return m;
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// Strides of the new axes in the old volume, in voxels.
struct OldStrides {
  std::array<std::ptrdiff_t, 3> along;  ///< per new axis
  std::ptrdiff_t first = 0;             ///< offset of new voxel (0, 0, 0)
};

OldStrides old_strides(const Index3& old_size, const AxisOrder& order) {
  const std::array<std::ptrdiff_t, 3> old{1, old_size[0], old_size[0] * old_size[1]};
  OldStrides strides{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t source = order.from[a];
    strides.along[a] = order.flipped[a] ? -old[source] : old[source];
    if (order.flipped[a]) strides.first += (old_size[source] - 1) * old[source];
  }
  return strides;
}

/// Copies in tiles over the new i axis and that along the old i axis, for cache locality in both buffers.
template <typename Copier>
void copy_in_tiles(const OldStrides& strides, const Index3& size, std::size_t old_i_axis,
                   const Copier& copy) {
  constexpr std::ptrdiff_t kTile = 32;
  const std::size_t tiled = old_i_axis == 0 ? 1 : old_i_axis;
  const std::size_t outer = 3 - tiled;
  const std::array<std::ptrdiff_t, 3> target{1, size[0], size[0] * size[1]};
  for (std::ptrdiff_t n = 0; n < size[outer]; ++n) {
    for (std::ptrdiff_t b = 0; b < size[tiled]; b += kTile) {
      const std::ptrdiff_t b_end = std::min<std::ptrdiff_t>(b + kTile, size[tiled]);
      for (std::ptrdiff_t a = 0; a < size[0]; a += kTile) {
        const std::ptrdiff_t a_end = std::min<std::ptrdiff_t>(a + kTile, size[0]);
        for (std::ptrdiff_t row = b; row < b_end; ++row) {
          const std::ptrdiff_t source = strides.first + n * strides.along[outer] + row * strides.along[tiled];
          const std::ptrdiff_t to = n * target[outer] + row * target[tiled];
          for (std::ptrdiff_t i = a; i < a_end; ++i) copy(source + i * strides.along[0], to + i);
        }
      }
    }
  }
}

}  // namespace

double determinant(const Matrix3& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
         m[2] * (m[3] * m[7] - m[4] * m[6]);
}

Vec3 Affine::apply(const Vec3& x) const {
  const Vec3 y = apply_linear(x);
  return {y[0] + offset[0], y[1] + offset[1], y[2] + offset[2]};
}

Vec3 Affine::apply_linear(const Vec3& x) const {
  return {linear[0] * x[0] + linear[1] * x[1] + linear[2] * x[2],
          linear[3] * x[0] + linear[4] * x[1] + linear[5] * x[2],
          linear[6] * x[0] + linear[7] * x[1] + linear[8] * x[2]};
}

double voxel_volume_mm3(const Grid& grid) {
  const double of_spacings = grid.spacing_mm[0] * grid.spacing_mm[1] * grid.spacing_mm[2];
  const double of_direction = std::abs(determinant(grid.direction_lps));
  return std::abs(of_direction - 1) <= kRoundingOfDeterminant ? of_spacings : of_spacings * of_direction;
}

double reference_length_mm(const Grid& grid) {
  return std::cbrt(voxel_volume_mm3(grid));
}

Affine index_to_lps_mm(const Grid& grid) {
  Affine map{grid.direction_lps, grid.origin_lps_mm};
  for (std::size_t n = 0; n < 9; ++n) map.linear[n] *= grid.spacing_mm[n % 3];
  return map;
}

std::pair<Vec3, Vec3> box_lps_mm(const Grid& grid, const Index3& first, const Index3& last) {
  const Affine to_lps = index_to_lps_mm(grid);
  std::pair box(to_lps.offset, to_lps.offset);
  for (std::size_t n = 0; n < 9; ++n) {
    const double low = to_lps.linear[n] * (static_cast<double>(first[n % 3]) - 0.5);
    const double high = to_lps.linear[n] * (static_cast<double>(last[n % 3]) + 0.5);
    box.first[n / 3] += std::min(low, high);
    box.second[n / 3] += std::max(low, high);
  }
  return box;
}

Affine lps_mm_to_index(const Grid& grid) {
  Affine map{inverted(index_to_lps_mm(grid).linear), {0, 0, 0}};
  const Vec3 origin = map.apply_linear(grid.origin_lps_mm);
  map.offset = {-origin[0], -origin[1], -origin[2]};
  return map;
}

Result<void> validate(const Grid& grid, const std::string& what) {
  const auto refuse = [&]<typename... Args>(fmt::format_string<Args...> fault, Args&&... args) {
    return fail(ErrorCode::kFailed, "{}: {}", what, fmt::format(fault, std::forward<Args>(args)...));
  };
  const auto& [x, y, z] = grid.size;
  for (const std::int64_t n : grid.size) {
    if (n < 1 || n > kMaxAxisSize) {
      return refuse("size {}x{}x{} voxels: each axis must have 1 to {}", x, y, z, kMaxAxisSize);
    }
  }
  if (x * y > kMaxVoxels / z) {
    return refuse("size {}x{}x{} voxels is above the limit of {} voxels", x, y, z, kMaxVoxels);
  }
  for (const double mm : grid.spacing_mm) {
    if (!std::isfinite(mm) || mm <= 0) return refuse("spacing {} mm must be positive and finite", mm);
    if (mm < kMinSpacingMm || mm > kMaxSpacingMm)
      return refuse("spacing {} mm must be from {} to {} mm", mm, kMinSpacingMm, kMaxSpacingMm);
  }
  if (!all_finite(grid.origin_lps_mm)) return refuse("the origin is not finite");
  if (!is_within_reach(grid.origin_lps_mm))
    return refuse("the origin ({} mm) must be within {} mm", fmt::join(grid.origin_lps_mm, ", "), kMaxMm);
  if (!all_finite(grid.direction_lps)) return refuse("the direction is not finite");
  const double volume = std::abs(determinant(normalized_columns(grid.direction_lps)));
  if (!(volume >= kMinDeterminant)) {  // also catches columns of length zero
    return refuse("the direction [{}] is singular: its axes must span space",
                  fmt::join(grid.direction_lps, " "));
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const double length = column_length(grid.direction_lps, a);
    if (length < kMinColumnLength || length > kMaxColumnLength)
      return refuse("axis {} of the direction has length {}, expected 1", a, length);
  }
  return {};
}

AxisOrder storage_order(const Grid& source) {
  const Matrix3 cosines = normalized_columns(source.direction_lps);
  AxisOrder best;
  double best_sum = -1;
  std::array<std::uint8_t, 3> from{0, 1, 2};
  do {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += std::abs(cosines[3 * a + from[a]]);
    if (sum > best_sum) {
      best_sum = sum;
      best.from = from;
    }
  } while (std::next_permutation(from.begin(), from.end()));
  for (std::size_t a = 0; a < 3; ++a) best.flipped[a] = cosines[3 * a + best.from[a]] < 0;
  return best;
}

AxisOrder inverse(const AxisOrder& order) {
  AxisOrder back;
  for (std::uint8_t a = 0; a < 3; ++a) {
    back.from[order.from[a]] = a;
    back.flipped[order.from[a]] = order.flipped[a];
  }
  return back;
}

Grid reordered(const Grid& grid, const AxisOrder& order) {
  Grid result;
  Vec3 first_voxel{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t source = order.from[a];
    result.size[a] = grid.size[source];
    result.spacing_mm[a] = grid.spacing_mm[source];
    for (std::size_t row = 0; row < 3; ++row) {
      const double along = grid.direction_lps[3 * row + source];
      result.direction_lps[3 * row + a] = order.flipped[a] ? 0.0 - along : along;  // never -0
    }
    if (order.flipped[a]) first_voxel[source] = static_cast<double>(grid.size[source] - 1);
  }
  result.origin_lps_mm = index_to_lps_mm(grid).apply(first_voxel);
  return result;
}

void reorder_voxels(const void* from, const Index3& size, const AxisOrder& order, std::size_t bytes_per_voxel,
                    void* to) {
  const auto voxels = static_cast<std::size_t>(size[0] * size[1] * size[2]);
  if (order.is_identity()) {
    std::memcpy(to, from, voxels * bytes_per_voxel);
    return;
  }
  const OldStrides strides = old_strides(size, order);
  const Index3 new_size{size[order.from[0]], size[order.from[1]], size[order.from[2]]};
  const std::size_t old_i_axis = inverse(order).from[0];
  const auto* source = static_cast<const std::byte*>(from);
  auto* target = static_cast<std::byte*>(to);
  const auto copy_all = [&](auto bytes) {  // faster with a constant
    const auto width = static_cast<std::ptrdiff_t>(bytes);
    copy_in_tiles(strides, new_size, old_i_axis, [=](std::ptrdiff_t old_voxel, std::ptrdiff_t new_voxel) {
      std::memcpy(target + new_voxel * width, source + old_voxel * width, bytes);
    });
  };
  switch (bytes_per_voxel) {
    case 1: return copy_all(std::integral_constant<std::size_t, 1>{});
    case 2: return copy_all(std::integral_constant<std::size_t, 2>{});
    case 4: return copy_all(std::integral_constant<std::size_t, 4>{});
    case 8: return copy_all(std::integral_constant<std::size_t, 8>{});
    default: copy_all(bytes_per_voxel);
  }
}

Grid coarse_grid(const Grid& grid, int level) {
  Grid coarse = grid;
  const double middle = (std::ldexp(1.0, level) - 1) / 2;  // of the first block, in voxels
  coarse.origin_lps_mm = index_to_lps_mm(grid).apply({middle, middle, middle});
  for (std::size_t a = 0; a < 3; ++a) {
    coarse.size[a] = ((grid.size[a] - 1) >> level) + 1;
    coarse.spacing_mm[a] = std::ldexp(grid.spacing_mm[a], level);
  }
  return coarse;
}

}  // namespace splatlas
