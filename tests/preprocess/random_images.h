// Random volumes in grids without symmetry.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "preprocess/import/images/import_image.h"
#include "tests/support/axis_orders.h"

namespace splatlas {

inline constexpr std::array<VoxelType, 8> kVoxelTypes{
    VoxelType::kUInt8,  VoxelType::kInt8,  VoxelType::kUInt16,  VoxelType::kInt16,
    VoxelType::kUInt32, VoxelType::kInt32, VoxelType::kFloat32, VoxelType::kFloat64};

/// Rotation by `angle` around z and then around x, columns mirrored by `order`.
inline Matrix3 oblique_direction(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, -s, 0, c * s, c * c, -s, s * s, s * c, c};
}

/// Sizes, spacings and origin without symmetry, rotated by `angle` in radians.
inline Grid awkward_grid(double angle) {
  Grid grid;
  grid.size = {7, 5, 4};
  grid.spacing_mm = {0.75, 1.5, 3.25};
  grid.origin_lps_mm = {-12.5, 33.25, 7};
  grid.direction_lps = oblique_direction(angle);
  return grid;
}

/// The same volume in another axis order.
inline Image in_order(const Image& image, const AxisOrder& order) {
  Image result{reordered(image.grid, order), {image.voxels.type, {}}};
  result.voxels.bytes.resize(image.voxels.bytes.size());
  reorder_voxels(image.voxels.bytes.data(), image.grid.size, order, bytes_of(image.voxels.type),
                 result.voxels.bytes.data());
  return result;
}

/// Any values of the type; finite for floats.
inline Image random_volume(const Grid& grid, VoxelType type, std::mt19937& random) {
  Image image{grid, {type, std::vector<std::byte>(static_cast<std::size_t>(grid.voxels()) * bytes_of(type))}};
  visit_voxel_type(type, [&]<typename T>(T) {
    for (std::int64_t v = 0; v < grid.voxels(); ++v) {
      if constexpr (std::is_integral_v<T>) {
        image.voxels.as<T>()[v] = static_cast<T>(random());
      } else {
        image.voxels.as<T>()[v] = static_cast<T>(std::uniform_real_distribution<double>(-1e6, 1e6)(random));
      }
    }
  });
  return image;
}

/// Labels 0 to 3 in clusters; the third is the maximum of the type below 2^24, which floats represent
/// exactly.
inline Image random_labels(const Grid& grid, VoxelType type, std::mt19937& random) {
  Image image{grid, {type, std::vector<std::byte>(static_cast<std::size_t>(grid.voxels()) * bytes_of(type))}};
  visit_voxel_type(type, [&]<typename T>(T) {
    double largest = 16777215;
    if constexpr (std::is_integral_v<T>) largest = static_cast<double>(std::numeric_limits<T>::max());
    T label = 0;
    for (std::int64_t v = 0; v < grid.voxels(); ++v) {
      if (random() % 3 == 0) label = static_cast<T>(std::array<double, 4>{0, 1, 2, largest}[random() % 4]);
      image.voxels.as<T>()[v] = label;
    }
  });
  return image;
}

}  // namespace splatlas
