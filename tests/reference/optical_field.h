// Optical properties of the selected voxels, pre-classified.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"

namespace splatlas::reference {

/// Extinction and emission (colour times extinction), 1/mm, linear RGB.
struct VoxelOptics {
  double extinction = 0;
  std::array<double, 3> emission{0, 0, 0};

  void add(double weight, const VoxelOptics& other);
};

/// One entry per voxel of the storage grid. Voxels not selected as volume have zero extinction and emission,
/// as in a masked copy.
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

/// `hybrid_shading`: lights boundary voxels by their normals, for `view`.
[[nodiscard]] OpticalField optical_field(const AtlasContent& content, const Selection& selection,
                                         const ParallelView& view, bool hybrid_shading);

}  // namespace splatlas::reference
