// Observed orders of convergence under refined sampling.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/result.h"

namespace splatlas {

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
