// What every voxel of a selection emits and absorbs: classified before interpolation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"

namespace splatlas::reference {

/// Extinction and emission (colour times extinction), 1/mm, linear light.
struct VoxelOptics {
  double extinction = 0;
  std::array<double, 3> emission{0, 0, 0};

  void add(double weight, const VoxelOptics& other);
};

/// One entry per voxel of the storage grid; voxels that the selection does not draw as volume are dark and
/// clear, as if they had been cut out of the volume ("masked copy").
struct OpticalField {
  Grid grid;
  std::vector<VoxelOptics> voxels;
  double mean_densest = 0;  ///< of all voxels that are drawn, where their transfer function is densest, 1/mm

  /// Dark and clear beyond the grid.
  [[nodiscard]] VoxelOptics at(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// Between the eight voxels around a point in continuous indices: a tent kernel along every axis.
  [[nodiscard]] VoxelOptics trilinear(const Vec3& index) const;
};

/// `hybrid_shading`: boundary voxels are lit by their normals, as seen in `view`.
[[nodiscard]] OpticalField optical_field(const AtlasContent& content, const Selection& selection,
                                         const ParallelView& view, bool hybrid_shading);

}  // namespace splatlas::reference
