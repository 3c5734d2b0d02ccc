// The truth of a masked copy, in double precision, fast enough for whole pictures of a head.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "player/render_options.h"
#include "tests/reference/masked_volume.h"
#include "tests/reference/perspective.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_picture.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Between voxel centres, either extinction and emission are trilinear, or the grey value is, and classified
/// then.
using splatlas::Classification;

/// A ray caster as in reference_volume.h, for one look of grey values. Rays are cut at every plane of voxel
/// centres and, where the grey value is classified after interpolation, where it passes a knot of the look;
/// the optical depth is then a polynomial, and exact, and the colour is taken by Gauss-Legendre's rule on
/// optical depths of at most 1/4. What a transmittance of 1e-7 hides is left out. Immutable: safe to share
/// between threads.
class GreyTruth {
 public:
  /// Keeps a reference to `volume`. Cost: one pass over the voxels; a byte per voxel.
  GreyTruth(const MaskedVolume& volume, GreyAppearance appearance, Classification classification);

  /// Light along a ray from `from_mm` on. Cost: the cells that the ray passes; empty ones take a few
  /// nanoseconds.
  [[nodiscard]] RayRadiance along(const Ray& ray, double from_mm) const;

 private:
  struct Corners;
  [[nodiscard]] std::size_t cell_number(std::int64_t i, std::int64_t j, std::int64_t k) const;
  [[nodiscard]] Corners corners_of(std::int64_t i, std::int64_t j, std::int64_t k) const;
  void mark_visible_cells();
  [[nodiscard]] RayRadiance in_cell(const Corners& corners, const Ray& ray, const Index3& cell,
                                    double from_mm, double to_mm) const;

  const MaskedVolume& volume_;
  GreyAppearance appearance_;
  Classification classification_;
  std::vector<std::array<double, 4>> light_;  // of whole grey values: extinction, emission
  std::vector<std::uint8_t> visible_;         // per cell, from one before the first voxel on
};

/// The ray through picture coordinates (x, y); a pixel's centre is at its number plus one half.
using RayOfPixel = std::function<Ray(double x, double y)>;

/// One ray through the centre of every pixel, from `from_mm` on. `threads`: 0 for one per core.
[[nodiscard]] ReferencePicture render_grey_truth(const GreyTruth& truth, const PictureSize& size,
                                                 const RayOfPixel& ray, double from_mm, unsigned threads);
// In parallel projection, and in perspective.
[[nodiscard]] ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid,
                                                 const ParallelView& view, unsigned threads);

[[nodiscard]] ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid,
                                                 const PerspectiveView& view, unsigned threads);

}  // namespace splatlas::reference
