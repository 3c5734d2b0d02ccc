// Reference for post-classification of any selection.
#pragma once

#include <vector>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/transfer_function.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Structures with equal transfer functions form a field of grey values. Other voxels have an invisible
/// value: 0, or else the first point of the transfer function. The field is interpolated trilinearly, then
/// classified. Its colour is the mean over the members among the eight voxels, with trilinear weights. Where
/// neither value is invisible, or without grey values, voxels are pre-classified. Unlit.
class InterpolatedGreys {
 public:
  InterpolatedGreys(const AtlasContent& content, const Selection& selection);

  /// Radiance along a ray from `from_mm` to `to_mm`, by `steps` slabs sampled at their centres. Slow.
  [[nodiscard]] RayRadiance along(const Ray& ray, double from_mm, double to_mm, int steps) const;

 private:
  struct Field {
    TransferCurve curve;
    bool classified_before = false;
    double outside = 0;                              // grey value of other voxels
    std::vector<bool> drawn;                         // per voxel
    std::vector<std::array<double, 3>> color;        // per voxel
    std::vector<std::array<double, 4>> optics = {};  // per voxel, if classified_before
  };
  /// Extinction and red, green and blue emission.
  [[nodiscard]] std::array<double, 4> at(const Field& field, const Vec3& index) const;
  [[nodiscard]] double grey(std::size_t voxel) const;

  Grid grid_;
  VoxelBuffer values_;
  double reference_length_mm_;
  std::vector<Field> fields_;
};

}  // namespace splatlas::reference
