// Masks and their membership volumes, and random volumes in grids without symmetry.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "preprocess/classify/classify_voxels.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/membership_volume.h"
#include "preprocess/structures/build_graph.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/axis_orders.h"

namespace splatlas {

/// One mask per structure, over the whole grid, i fastest.
using Masks = std::vector<std::vector<std::uint8_t>>;

inline MembershipVolume memberships_of(const Masks& masks, const Index3& size) {
  MembershipVolume memberships(size);
  for (StructureIndex s = 0; s < masks.size(); ++s) memberships.add(s, masks[s]);
  return memberships;
}

/// The class of every voxel.
inline std::vector<ClassId> volume_of(const ClassifiedVoxels& classification, const Index3& size) {
  return value_or_throw(decode_runs(classification.runs, size));
}

/// Structures "A", "B", ... without parents.
inline StructureGraph flat_graph(std::size_t structures) {
  std::vector<SourceStructure> sources(structures);
  for (std::size_t s = 0; s < structures; ++s) sources[s].name.push_back(static_cast<char>('A' + s));
  Notes notes;
  return build_graph(sources, {}, "", notes)->graph;
}

/// `value(i, j, k)` for every voxel, i fastest; true is 1.
template <typename Value>
std::vector<std::uint8_t> make_mask(const Index3& size, const Value& value) {
  std::vector<std::uint8_t> mask;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) mask.push_back(static_cast<std::uint8_t>(value(i, j, k)));
    }
  }
  return mask;
}

/// The balls of the golden phantom.
inline constexpr Index3 kPhantomSize{phantom::kSize, phantom::kSize, phantom::kSize};
inline Masks phantom_masks() {
  Masks masks;
  for (const phantom::Ball& ball : phantom::kBalls) {
    masks.push_back(make_mask(kPhantomSize, [&](auto i, auto j, auto k) {
      return ball.holds(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    }));
  }
  return masks;
}

inline constexpr std::array<VoxelType, 8> kVoxelTypes{
    VoxelType::kUInt8,  VoxelType::kInt8,  VoxelType::kUInt16,  VoxelType::kInt16,
    VoxelType::kUInt32, VoxelType::kInt32, VoxelType::kFloat32, VoxelType::kFloat64};

/// Sizes, spacings and origin without symmetry, rotated by `angle` in radians around z and then around x.
inline Grid awkward_grid(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {.size = {7, 5, 4},
          .spacing_mm = {0.75, 1.5, 3.25},
          .origin_lps_mm = {-12.5, 33.25, 7},
          .direction_lps = {c, -s, 0, c * s, c * c, -s, s * s, s * c, c}};
}

/// 8-bit values `value(i, j, k)`.
template <typename Value>
Image byte_image(const Grid& grid, const Value& value) {
  const std::vector<std::uint8_t> values = make_mask(grid.size, value);
  const auto bytes = std::as_bytes(std::span(values));
  return {grid, {VoxelType::kUInt8, {bytes.begin(), bytes.end()}}};
}

/// The same volume in another axis order.
inline Image in_order(const Image& image, const AxisOrder& order) {
  Image result{reordered(image.grid, order), {image.voxels.type, {}}};
  result.voxels.bytes.resize(image.voxels.bytes.size());
  reorder_voxels(image.voxels.bytes.data(), image.grid.size, order, bytes_of(image.voxels.type),
                 result.voxels.bytes.data());
  return result;
}

inline Image zeros(const Grid& grid, VoxelType type) {
  return {grid, {type, std::vector<std::byte>(static_cast<std::size_t>(grid.voxels()) * bytes_of(type))}};
}

/// Any values of the type; finite for floats.
inline Image random_volume(const Grid& grid, VoxelType type, std::mt19937& random) {
  Image image = zeros(grid, type);
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

/// Labels 0 to 3 in clusters; the third is the type's maximum below 2^24, which floats represent exactly.
inline Image random_labels(const Grid& grid, VoxelType type, std::mt19937& random) {
  Image image = zeros(grid, type);
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
