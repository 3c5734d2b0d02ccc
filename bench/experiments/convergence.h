// Observed orders of convergence under refined sampling of a smooth field.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "tests/reference/reference_picture.h"

namespace splatlas {

/// Four Gaussians around the origin of a cube of kFieldSideMm, which vanish at its faces. Grey values range
/// from 0 to about 1.
inline constexpr double kFieldSideMm = 48;
/// Extinction of grey value 1, 1/mm; proportional up to 2, above all grey values.
inline constexpr double kFieldExtinctionPerMm = 0.15;
[[nodiscard]] double smooth_field(const Vec3& at_mm);

/// Samples of the field at the centres of cubic voxels, as the grey values of one structure, "field".
[[nodiscard]] AtlasContent sampled_field(double voxel_mm);

/// Extinction and shade proportional to the grey value, per mm, for any voxel size.
[[nodiscard]] Selection field_selection(const AtlasContent& content, double voxel_mm);

/// Ground truth of the field itself, in double precision.
[[nodiscard]] reference::ReferencePicture field_truth(const View& view);

/// Least-squares slope of log(error) over log(step): 2 if halving the step quarters the error. Needs at least
/// two steps and positive numbers.
[[nodiscard]] double observed_order(std::span<const double> steps, std::span<const double> errors);

/// One refinement of a picture of a smooth field (four Gaussians, no borders).
struct Convergence {
  std::string refined;           ///< the refined quantity, and the ground truth
  std::string renderer;          ///< renderer and quality
  double theory = 2;             ///< order of the method
  std::vector<double> steps{};   ///< mm, or slabs per step
  std::vector<double> errors{};  ///< RMS of full scale

  [[nodiscard]] double order() const { return observed_order(steps, errors); }
};

/// Refines the grid: sheets at every quality and rays on finer and finer samples, against the field itself,
/// integrated in double precision. Trilinear reconstruction and constant slabs are of second order.
/// Refines the steps: rays with more equal steps per slab, against the exact integral of the trilinear field,
/// pre- and post-classified. Grey values and optical properties are linear along a step: second order.
[[nodiscard]] Result<std::vector<Convergence>> measure_convergence();

}  // namespace splatlas
