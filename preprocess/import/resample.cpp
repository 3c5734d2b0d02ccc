#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "format/tasks/thread_pool.h"
#include "preprocess/import/images/import_image.h"

namespace splatlas {
namespace {

/// The index in `from` of a voxel of `to`.
Affine index_map(const Grid& to, const Grid& from) {
  const Affine to_mm = index_to_lps_mm(to), to_index = lps_mm_to_index(from);
  Affine map;
  map.offset = to_index.apply(to_mm.offset);
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 unit{0, 0, 0};
    unit[a] = 1;
    const Vec3 column = to_index.apply_linear(to_mm.apply_linear(unit));
    for (std::size_t row = 0; row < 3; ++row) map.linear[3 * row + a] = column[row];
  }
  return map;
}

/// Calls visit(v, index) for every voxel v of `grid`, slices in parallel.
template <typename Visit>
void for_each_voxel(const Grid& grid, const Affine& map, const Visit& visit) {
  parallel_for(static_cast<std::size_t>(grid.size[2]), 0, [&](std::size_t slice) {
    const auto k = static_cast<std::int64_t>(slice);
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 voxel{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        visit(static_cast<std::size_t>(grid.offset(i, j, k)), map.apply(voxel));
      }
    }
  });
}

template <typename T>
class LinearSampler {
 public:
  LinearSampler(const T* values, const Grid& grid) : values_(values), grid_(grid) {
    outside_ = *std::min_element(values, values + grid.voxels());
  }

  [[nodiscard]] T at(const Vec3& index) const {
    std::array<std::array<std::int64_t, 2>, 3> ends{};
    Vec3 part;
    constexpr double kHalfVoxel = 0.5;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto last = static_cast<double>(grid_.size[a] - 1);
      if (!(index[a] >= -kHalfVoxel && index[a] <= last + kHalfVoxel)) return outside_;
      const double inside = std::clamp(index[a], 0.0, last);
      ends[a][0] = static_cast<std::int64_t>(inside);
      ends[a][1] = std::min(ends[a][0] + 1, grid_.size[a] - 1);
      part[a] = inside - static_cast<double>(ends[a][0]);
    }
    double sum = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
      const double weight = (x != 0 ? part[0] : 1 - part[0]) * (y != 0 ? part[1] : 1 - part[1]) *
                            (z != 0 ? part[2] : 1 - part[2]);
      if (weight > 0)
        sum += weight * static_cast<double>(values_[grid_.offset(ends[0][x], ends[1][y], ends[2][z])]);
    }
    if constexpr (std::is_integral_v<T>) return static_cast<T>(std::floor(sum + 0.5));
    return static_cast<T>(sum);
  }

 private:
  const T* values_;
  const Grid& grid_;
  T outside_;
};

}  // namespace

VoxelBuffer resample_nearest(const VoxelBuffer& voxels, const Grid& source, const Grid& grid) {
  const std::size_t bytes_each = bytes_of(voxels.type);
  const std::size_t from = static_cast<std::size_t>(source.voxels()) * bytes_each,
                    to = static_cast<std::size_t>(grid.voxels()) * bytes_each;
  const std::size_t layers = voxels.bytes.size() / from;
  VoxelBuffer result{voxels.type, std::vector<std::byte>(layers * to)};
  for_each_voxel(grid, index_map(grid, source), [&](std::size_t v, const Vec3& index) {
    Index3 nearest;
    for (std::size_t a = 0; a < 3; ++a) {
      const double rounded = std::floor(index[a] + 0.5);
      if (!(rounded >= 0 && rounded < static_cast<double>(source.size[a]))) return;
      nearest[a] = static_cast<std::int64_t>(rounded);
    }
    const auto at = static_cast<std::size_t>(source.offset(nearest[0], nearest[1], nearest[2]));
    for (std::size_t n = 0; n < layers; ++n)
      std::memcpy(&result.bytes[n * to + v * bytes_each], &voxels.bytes[n * from + at * bytes_each],
                  bytes_each);
  });
  return result;
}

VoxelBuffer resample_linear(const Image& image, const Grid& grid) {
  VoxelBuffer result{image.voxels.type, std::vector<std::byte>(static_cast<std::size_t>(grid.voxels()) *
                                                               bytes_of(image.voxels.type))};
  visit_voxel_type(image.voxels.type, [&]<typename T>(T) {
    const LinearSampler<T> sampler(image.voxels.as<T>(), image.grid);
    T* const to = result.as<T>();
    for_each_voxel(grid, index_map(grid, image.grid),
                   [&](std::size_t v, const Vec3& index) { to[v] = sampler.at(index); });
  });
  return result;
}

double overlap(const Grid& grid, const Grid& other) {
  constexpr int kPoints = 32;
  const Affine map = index_map(grid, other);
  int inside = 0;
  for (int n = 0; n < kPoints * kPoints * kPoints; ++n) {
    const std::array<int, 3> point{n % kPoints, n / kPoints % kPoints, n / kPoints / kPoints};
    Vec3 index;
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (point[a] + 0.5) / kPoints * static_cast<double>(grid.size[a]) - 0.5;
    const Vec3 found = map.apply(index);
    bool is_inside = true;
    for (std::size_t a = 0; a < 3; ++a)
      is_inside = is_inside && found[a] >= -0.5 && found[a] <= static_cast<double>(other.size[a]) - 0.5;
    inside += is_inside ? 1 : 0;
  }
  return static_cast<double>(inside) / (kPoints * kPoints * kPoints);
}

std::optional<Margin> margin_around(const Grid& grid, const Grid& other) {
  const Grid inner = reordered(grid, storage_order(grid)), outer = reordered(other, storage_order(other));
  const Vec3 first = lps_mm_to_index(inner).apply(outer.origin_lps_mm);
  Margin margin, of_other;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(std::abs(first[a]) < static_cast<double>(kMaxAxisSize))) return std::nullopt;
    const std::int64_t low = std::llround(first[a]), high = low + outer.size[a] - inner.size[a];
    margin.low[a] = std::max<std::int64_t>(-low, 0);
    margin.high[a] = std::max<std::int64_t>(high, 0);
    of_other.low[a] = std::max<std::int64_t>(low, 0);
    of_other.high[a] = std::max<std::int64_t>(-high, 0);
  }
  const bool fits = have_same_voxels(widened(inner, margin), widened(outer, of_other));
  return fits ? std::optional(margin) : std::nullopt;
}

std::optional<Grid> union_of(const Grid& a, const Grid& b) {
  constexpr double kMostVoxels = 1 << 30;
  const std::optional<Margin> margin = margin_around(a, b);
  if (!margin) return std::nullopt;
  const Grid whole = widened(a, before_reordering(*margin, storage_order(a)));
  double voxels = 1;
  for (const std::int64_t size : whole.size) voxels *= static_cast<double>(size);
  const auto least = static_cast<double>(std::max(a.voxels(), b.voxels()));
  return voxels <= std::max(kMostVoxels, 2 * least) ? std::optional(whole) : std::nullopt;
}

}  // namespace splatlas
