// Reference ray caster for masked copies in double precision, fast enough for whole pictures of a head.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "player/render_options.h"
#include "tests/reference/masked_volume.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_picture.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// kBefore interpolates extinction and emission, kAfter the grey value, ahead of classification.
using splatlas::Classification;

/// A ray caster as in reference_volume.h for one appearance of grey values. Cuts rays at planes of voxel
/// centres and, for post-classification, at the knots of the appearance. The optical depth is then a
/// polynomial, integrated exactly; the colour is integrated by Gauss-Legendre quadrature over optical depths
/// of at most 1/4. Rays end at a transmittance of 1e-7. Hybrid shading as in the model: the emission of lit
/// voxels is multiplied before interpolation, or the colour by the mean factor of the selected voxels around.
/// Immutable and thread-safe.
class GreyTruth {
 public:
  /// Keeps a reference to `volume`. `lit_for`: lights voxels with normals for this view; null: unlit. Cost:
  /// one pass over the voxels, and a byte per voxel.
  GreyTruth(const MaskedVolume& volume, GreyAppearance appearance, Classification classification,
            const ParallelView* lit_for = nullptr);

  /// Radiance along a ray from `from_mm` on. Cost: linear in the crossed cells; empty ones take a few
  /// nanoseconds.
  [[nodiscard]] RayRadiance along(const Ray& ray, double from_mm) const;

 private:
  using Corners = std::array<std::uint8_t, 8>;  // grey values of a cell, i fastest
  struct CornerLighting {
    double factor = 0;  // of a selected voxel's emission
    double member = 0;  // 1 in the selection, otherwise 0
  };
  [[nodiscard]] std::size_t cell_number(std::int64_t i, std::int64_t j, std::int64_t k) const;
  [[nodiscard]] Corners corners_of(std::int64_t i, std::int64_t j, std::int64_t k) const;
  [[nodiscard]] std::array<CornerLighting, 8> lighting_of(const Index3& cell) const;
  void mark_visible_cells();
  [[nodiscard]] RayRadiance in_cell(const Corners& corners, const Ray& ray, const Index3& cell,
                                    double from_mm, double to_mm) const;

  const MaskedVolume& volume_;
  GreyAppearance appearance_;
  Classification classification_;
  std::vector<std::array<double, 4>> optics_;  // per integer grey value: extinction, emission
  std::vector<std::uint8_t> visible_;          // per cell, from one before the first voxel on
  std::vector<double> factors_;                // per packed normal; empty if unlit
};

/// One ray per pixel centre. `threads`: 0 for one per core.
[[nodiscard]] ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid,
                                                 const ParallelView& view, unsigned threads);
[[nodiscard]] ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid,
                                                 const PerspectiveView& view, unsigned threads);

}  // namespace splatlas::reference
