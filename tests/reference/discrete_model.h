// What the renderer computes, in double precision: slabs of constant light, and a sheet of finite resolution.
// Where a picture differs from the truth, this model tells a fault (the picture differs from the model by
// more than float rounding) from the error that the method has.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "format/run_model.h"
#include "player/render_frame.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Slabs per slice that the renderer documents for a quality.
[[nodiscard]] int slabs_per_slice(Quality quality);

/// Sheet pixels per voxel that the renderer documents for a quality.
[[nodiscard]] int sheet_pixels_per_voxel(Quality quality, const ParallelView& view, const OpticalField& field,
                                         Axis principal);

class DiscreteModel {
 public:
  /// Keeps references. `pixels_per_voxel`: of the sheet; 0 stands for a sheet of unlimited resolution, which
  /// leaves the slabs as the only approximation. `principal`: the axis that slices are normal to.
  /// `parts`: slabs per slice. One lies around its slice; several between it and the next, each with the
  /// light halfway through.
  DiscreteModel(const OpticalField& field, const ParallelView& view, Axis principal, int pixels_per_voxel,
                int parts = 1);

  /// The volume in front of every depth (along the principal axis in voxels, growing away from the viewer)
  /// and all of it, last; at picture coordinates. Within a slab the light is as if it were constant between
  /// what the warp shows in front of the slab and behind it.
  [[nodiscard]] std::vector<RayRadiance> at(double x, double y, std::span<const double> depths) const;
  /// All of the volume; the mean over the pixel where voxels are finer than the picture.
  [[nodiscard]] RayRadiance pixel_mean(int column, int row) const;

 private:
  struct Place {
    double u = 0, v = 0;  ///< where a ray meets the middle slice, in voxels
  };
  [[nodiscard]] Place place_of(double x, double y) const;
  [[nodiscard]] std::vector<RayRadiance> along_ray(const Place& place, std::span<const double> depths) const;
  [[nodiscard]] std::vector<RayRadiance> warped(const Place& place, std::span<const double> depths) const;
  /// Where there is the volume alone, in normal and high quality.
  [[nodiscard]] RayRadiance warped_cubic(const Place& place) const;
  /// The whole volume at a pixel of the sheet; pictures ask for each again and again.
  [[nodiscard]] const RayRadiance& sheet_pixel(std::int64_t column, std::int64_t row) const;
  /// What the warp's weights make up for: rays move across a slice along its slab.
  [[nodiscard]] double smear() const;
  [[nodiscard]] VoxelOptics in_slice(std::int64_t k, double scan, double row) const;
  /// Light of the middle of the n-th slab from the viewer, along a ray, and where the slab begins.
  struct SlabSample {
    VoxelOptics light;
    double begin = 0;  ///< depth, in voxels
  };
  [[nodiscard]] SlabSample sample(std::int64_t n, const Place& place) const;
  [[nodiscard]] double first_slab() const;
  [[nodiscard]] std::int64_t slabs() const { return parts_ == 1 ? slices_ : (slices_ + 1) * parts_; }

  const OpticalField& field_;
  const ParallelView& view_;
  ScanOrder axes_;
  int pixels_per_voxel_, parts_;
  std::int64_t slices_;
  double middle_;
  Vec3 per_mm_;
  mutable std::map<std::pair<std::int64_t, std::int64_t>, RayRadiance>
      sheet_;  // as far as it has been asked for
};

}  // namespace splatlas::reference
