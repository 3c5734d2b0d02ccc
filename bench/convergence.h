// Orders of convergence: how fast errors fall as sampling gets finer, against theory.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// The slope of log(error) over log(step), by least squares: 2 where half the step leaves a quarter of the
/// error. At least two steps, all numbers above 0.
[[nodiscard]] double observed_order(std::span<const double> steps, std::span<const double> errors);

/// One way to refine a picture of a smooth field (four Gaussians, no borders).
struct Convergence {
  std::string refined;           ///< what gets finer, and against which truth
  std::string renderer;          ///< ours, with its quality
  double theory = 2;             ///< order that the method must have
  std::vector<double> steps{};   ///< in mm, or in slabs
  std::vector<double> errors{};  ///< RMS in full scales

  [[nodiscard]] double order() const { return observed_order(steps, errors); }
};

/// The grid: the field itself, integrated in double precision, against its samples on finer and finer grids;
/// sheets at every quality and rays. Reconstruction (trilinear) and slabs (constant) are both of second
/// order. The step: rays of a grid with more and more equal steps to the slab, against the exact integral of
/// the grid's own field, classified before and after interpolation; grey values and light are linear along a
/// step, second order.
[[nodiscard]] Result<std::vector<Convergence>> measure_convergence();

}  // namespace splatlas
