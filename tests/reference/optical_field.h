// Optical properties of the selected voxels, pre-classified.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Extinction and emission (colour times extinction), 1/mm, linear RGB.
struct VoxelOptics {
  double extinction = 0;
  std::array<double, 3> emission{0, 0, 0};

  void add(double weight, const VoxelOptics& other);
};
/// Optical properties of a transfer function's value in this colour.
[[nodiscard]] VoxelOptics optics_of(const TransferValue& value, const std::array<double, 3>& color);
/// Radiance of a slab of constant optical properties; exact.
[[nodiscard]] RayRadiance slab(const VoxelOptics& optics, double length_mm);

/// Calls visit(corner, weight) for the eight voxels around a continuous voxel index, with trilinear weights.
template <typename Visit>
void for_each_corner(const Vec3& index, const Visit& visit) {
  for (unsigned n = 0; n < 8; ++n) {
    double weight = 1;
    Index3 corner{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = std::floor(index[a]);
      const bool high = (n >> a & 1u) != 0;
      weight *= high ? index[a] - low : 1 - (index[a] - low);
      corner[a] = static_cast<std::int64_t>(low) + (high ? 1 : 0);
    }
    visit(corner, weight);
  }
}

/// Side of a cube with the volume of a voxel, by the triple product of its edges.
[[nodiscard]] double voxel_side_mm(const Grid& grid);

/// The n-th grey value.
[[nodiscard]] double value_of(const VoxelBuffer& values, std::size_t n);

/// One entry per voxel of the storage grid. Those not selected as volume have no extinction and emission.
struct OpticalField {
  Grid grid;
  std::vector<VoxelOptics> voxels;
  double mean_densest =
      0;  ///< mean over all selected voxels of the maximum extinction of their transfer function, 1/mm

  /// Zero outside the grid.
  [[nodiscard]] VoxelOptics at(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// Trilinear interpolation at a continuous voxel index.
  [[nodiscard]] VoxelOptics trilinear(const Vec3& index) const;
};

/// Structures whose shares in the opacity replace the colour channels of a picture.
using ShareChannels = std::array<StructureIndex, 3>;
/// Colour channels that show the share of a structure: 1 in its channel.
[[nodiscard]] inline std::array<double, 3> share_color(const ShareChannels& channels, StructureIndex s) {
  return {channels[0] == s ? 1.0 : 0.0, channels[1] == s ? 1.0 : 0.0, channels[2] == s ? 1.0 : 0.0};
}
/// The same of a surface with an opacity, premultiplied.
[[nodiscard]] inline std::array<double, 4> share_rgba(const ShareChannels& channels, StructureIndex s,
                                                      double opacity) {
  const std::array<double, 3> color = share_color(channels, s);
  return {opacity * color[0], opacity * color[1], opacity * color[2], opacity};
}

/// `hybrid_shading`: lights boundary voxels by their normals. `shares`: emits shares, not colours; unlit.
[[nodiscard]] OpticalField optical_field(const AtlasContent& content, const Selection& selection,
                                         const ParallelView& view, bool hybrid_shading,
                                         const std::optional<ShareChannels>& shares = std::nullopt);

}  // namespace splatlas::reference
