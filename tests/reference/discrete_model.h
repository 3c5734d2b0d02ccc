// Discrete model of the sheet renderer in double precision: slabs of constant optics, a finite sheet.
// A difference between picture and model beyond float rounding is a fault. A difference between model and
// ground truth is the error of the method.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "format/content/run_model.h"
#include "player/renderer.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_cut.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// The documented number of slabs per slice.
[[nodiscard]] int slabs_per_slice(Quality quality);

/// The documented resolution of the sheet, in pixels per voxel.
[[nodiscard]] int sheet_pixels_per_voxel(Quality quality, const ParallelView& view, const OpticalField& field,
                                         Axis principal);

class DiscreteModel {
 public:
  /// Keeps references. `pixels_per_voxel`: resolution of the sheet; 0: unlimited, so that slabs remain the
  /// only approximation. `principal`: the axis normal to slices. `parts`: slabs per slice. A single slab is
  /// centred on its slice. Several lie between it and the next slice, and are sampled at their centres.
  /// `cut`: clips slabs; null: no cut.
  DiscreteModel(const OpticalField& field, const ParallelView& view, Axis principal, int pixels_per_voxel,
                int parts = 1, const ReferenceCut* cut = nullptr);

  /// The volume in front of each depth and, last, all of it, at picture coordinates. Depths run along the
  /// principal axis in voxels, away from the viewer. Within a slab, interpolates between the warped radiance
  /// in front of and behind it, as for constant optical properties.
  [[nodiscard]] std::vector<RayRadiance> at(double x, double y, std::span<const double> depths) const;
  /// The whole volume, averaged over the pixel where voxels are smaller than pixels.
  [[nodiscard]] RayRadiance pixel_mean(int column, int row) const;

 private:
  struct Place {
    double u = 0, v = 0;  ///< intersection of the ray with the middle slice, in voxels
  };
  [[nodiscard]] Place place_of(double x, double y) const;
  [[nodiscard]] std::vector<RayRadiance> along_ray(const Place& place, std::span<const double> depths) const;
  [[nodiscard]] std::vector<RayRadiance> warped(const Place& place, std::span<const double> depths) const;
  /// Used without surfaces, in normal and high quality.
  [[nodiscard]] RayRadiance warped_cubic(const Place& place) const;
  /// The whole volume at a sheet pixel. Cached.
  [[nodiscard]] const RayRadiance& sheet_pixel(std::int64_t column, std::int64_t row) const;
  /// Correction of the bilinear weights of the warp for the motion of rays across a slice.
  [[nodiscard]] double smear() const;
  [[nodiscard]] double first_slab() const;
  [[nodiscard]] std::int64_t slabs() const { return parts_ == 1 ? slices_ : (slices_ + 1) * parts_; }

  /// Kept fraction of a slab centred at position `k` along the principal axis.
  [[nodiscard]] double kept_fraction(const Place& place, double k) const;
  /// Kept part of the ray through picture coordinates, as depths.
  [[nodiscard]] RayInterval kept_depths(double x, double y) const;
  /// The point of a ray at position `k` along the principal axis.
  [[nodiscard]] Vec3 index_at(const Place& place, double k) const;

  const OpticalField& field_;
  const ParallelView& view_;
  const ReferenceCut* cut_;
  ScanOrder axes_;
  int pixels_per_voxel_, parts_;
  std::int64_t slices_;
  double middle_;
  Vec3 per_mm_;
  mutable std::map<std::pair<std::int64_t, std::int64_t>, RayRadiance> sheet_;  // cache
};

}  // namespace splatlas::reference
