#include "bench/experiments/convergence.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(ObservedOrder, IsThePowerOfTheStep) {
  const std::array steps{2.0, 1.0, 0.5, 0.2};
  for (const double order : {0.5, 1.0, 2.0, 4.0}) {
    std::array<double, 4> errors{};
    for (std::size_t n = 0; n < steps.size(); ++n) errors[n] = 0.03 * std::pow(steps[n], order);
    EXPECT_NEAR(observed_order(steps, errors), order, 1e-12);
  }
}

TEST(ObservedOrder, FitsAllSteps) {
  const std::array steps{4.0, 2.0, 1.0};
  const std::array errors{16.0, 2.0, 1.0};  // slopes 3 and 1
  EXPECT_NEAR(observed_order(steps, errors), 2.0, 1e-12);
}

/// Rays in the symmetry plane of the field, where integrals of Gaussians are known.
TEST(SmoothField, TruthIsTheIntegralOfTheField) {
  const View view = *view_of(Camera{}, {3, 3}, {.center_lps_mm = {0, 0, 0}, .radius_mm = 8});
  const reference::ReferencePicture truth = field_truth(view);
  for (int n = 0; n < 9; ++n) {
    const Vec3 through = view.plane.point_lps_mm(n % 3 + 0.5, n / 3 + 0.5);
    double depth = 0;  // trapezoidal rule: exact to rounding, as the field vanishes at both ends
    constexpr double kStep = 0.25;
    for (double s = -40; s <= 40; s += kStep) {
      Vec3 at = through;
      for (std::size_t a = 0; a < 3; ++a) at[a] += s * view.plane.forward_lps[a];
      depth += kStep * kFieldExtinctionPerMm * smooth_field(at);
    }
    EXPECT_NEAR(truth.pixels[static_cast<std::size_t>(n)][3], -std::expm1(-depth), 1e-9);
  }
}

/// Samples, selection and ground truth belong to one field: at voxels, its optical properties are exact for
/// every voxel size.
TEST(SmoothField, SamplesHoldTheFieldAtVoxels) {
  for (const double voxel_mm : {3.0, 6.0}) {
    const AtlasContent content = sampled_field(voxel_mm);
    const Grid grid = storage_grid(content);
    const Affine to_lps = index_to_lps_mm(grid);
    const auto greys = content.values.as<float>();
    for (std::int64_t k = 0; k < grid.size[2]; ++k) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 at = to_lps.apply({static_cast<double>(i), 2, static_cast<double>(k)});
        EXPECT_NEAR(greys[static_cast<std::size_t>(grid.offset(i, 2, k))], smooth_field(at), 1e-6);
      }
    }
    EXPECT_NO_THROW((void)field_selection(content, voxel_mm));
  }
}

}  // namespace
}  // namespace splatlas
