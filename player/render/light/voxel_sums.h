// Sums over the voxels of a block, for the means of drafts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "player/render/decode/lit_voxels.h"
#include "player/render/transfer/shading.h"

namespace splatlas {

/// Sums of optical properties of voxels (1/mm), and of their normals, weighted by the emission they light.
struct VoxelSums {
  float extinction = 0;
  std::array<float, 3> emission{};
  float weight = 0, lit = 0;  ///< of the emission: all of it, and its lit part
  std::array<float, 3> normal{};

  /// Adds a voxel, weighted by its emission. `lit`: null unless it is lit.
  void add(float of_extinction, const std::array<float, 3>& of_emission, const LitVoxel* of_lit,
           const UnpackedNormals& unpacked) {
    const float of_weight = of_emission[0] + of_emission[1] + of_emission[2];
    extinction += of_extinction;
    weight += of_weight;
    for (std::size_t c = 0; c < 3; ++c) emission[c] += of_emission[c];
    if (of_lit != nullptr)
      add_light(of_weight * static_cast<float>(of_lit->lit) / LitVoxel::kAllLit, of_lit->normal, unpacked);
  }
  /// Adds the lit emission of a voxel, in the unit of `weight`.
  void add_light(float emission_lit, PackedNormal of_voxel, const UnpackedNormals& unpacked) {
    lit += emission_lit;
    normal[0] += emission_lit * unpacked.x[of_voxel];
    normal[1] += emission_lit * unpacked.y[of_voxel];
    normal[2] += emission_lit * unpacked.z[of_voxel];
  }
  /// The colour whose product with the weight is the emission.
  [[nodiscard]] std::array<float, 3> color() const {
    if (weight <= 0) return {};
    return {emission[0] / weight, emission[1] / weight, emission[2] / weight};
  }
  /// Share of the emission that is lit, as LitVoxel::lit.
  [[nodiscard]] std::uint16_t lit_share() const {
    const float share = weight > 0 ? std::min(lit / weight, 1.0f) : 0;
    return static_cast<std::uint16_t>(std::lround(share * LitVoxel::kAllLit));
  }
};

}  // namespace splatlas
