// The truth of classification after interpolation for any selection, as its definition has it.
#pragma once

#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/transfer_function.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Structures with equal transfer functions make a field of grey values: those of their voxels, all others
/// count as what is not there (0, else the transfer function's lowest point). It is trilinear between voxels,
/// and classified then. Its colour is the mean of the voxels around that belong to it, by their trilinear
/// weights. Where neither hides what is not there, or there are no grey values, voxels are classified first.
/// Unlit.
class InterpolatedGreys {
 public:
  InterpolatedGreys(const AtlasContent& content, const Selection& selection);

  /// Light along a ray from `from_mm` to `to_mm`, as `steps` slabs of what is in their middle. Slow.
  [[nodiscard]] RayRadiance along(const Ray& ray, double from_mm, double to_mm, int steps) const;

 private:
  struct Field {
    TransferCurve curve;
    bool classified_before = false;
    double outside = 0;                             // what is not there counts as
    std::vector<bool> drawn;                        // per voxel
    std::vector<std::array<double, 3>> color;       // per voxel
    std::vector<std::array<double, 4>> light = {};  // per voxel, where classified before
  };
  /// Extinction, and emission in red, green and blue.
  [[nodiscard]] std::array<double, 4> at(const Field& field, const Vec3& index) const;
  [[nodiscard]] double grey(std::size_t voxel) const;

  Grid grid_;
  VoxelBuffer values_;
  double reference_length_mm_;
  std::vector<Field> fields_;
};

}  // namespace splatlas::reference
