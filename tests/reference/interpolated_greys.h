// Reference for post-classification of any selection.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/transfer_function.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"

namespace splatlas::reference {

/// Structures with equal transfer functions form a field of grey values. Other voxels have an invisible
/// value: 0, or else the first point of the transfer function. The field is interpolated trilinearly, then
/// classified. Its colour is the mean over the members among the eight voxels, with trilinear weights. Where
/// neither value is invisible, or without grey values, voxels are pre-classified. Unlit. `shares`: emits the
/// shares of structures in the extinction, by the trilinear weights of the drawn voxels.
class InterpolatedGreys {
 public:
  InterpolatedGreys(const AtlasContent& content, const Selection& selection,
                    const std::optional<ShareChannels>& shares = std::nullopt);

  /// Radiance along a ray from `from_mm` to `to_mm`, by `steps` slabs sampled at their centres. Slow.
  [[nodiscard]] RayRadiance along(const Ray& ray, double from_mm, double to_mm, int steps) const;

 private:
  struct Field {
    TransferCurve curve;
    bool classified_before = false;
    double outside = 0;                                       // grey value of other voxels
    std::vector<std::optional<std::array<double, 3>>> color;  // of the voxels that it draws
  };
  [[nodiscard]] VoxelOptics at(const Field& field, const Vec3& index) const;
  [[nodiscard]] VoxelOptics shares_at(double extinction, const Vec3& index) const;
  [[nodiscard]] const Grid& grid() const { return classified_before_.grid; }

  VoxelBuffer values_;
  OpticalField classified_before_;
  double reference_length_mm_;
  std::vector<Field> fields_;
  std::optional<ShareChannels> shares_;
  std::vector<StructureIndex> structures_;  // of the drawn voxels, else kNoStructure
};

}  // namespace splatlas::reference
