#include "tests/reference/reference_volume.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_scene.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = HUGE_VAL;

ParallelView view_of(const RandomScene& scene) {
  return *parallel_view(scene.camera, scene.options.size, scene.content.display);
}

/// Brute-force quadrature: many steps of constant optical properties.
RayRadiance brute_force(const OpticalField& field, const Ray& ray, double from_mm, double to_mm, int steps) {
  RayRadiance sum;
  const double step_mm = (to_mm - from_mm) / steps;
  for (int n = 0; n < steps; ++n) {
    sum.add(slab(field.trilinear(ray.at(from_mm + (n + 0.5) * step_mm)), step_mm));
  }
  return sum;
}

TEST(ReferenceVolume, EqualsBruteForce) {
  int compared = 0;
  for (std::uint32_t number = 0; number < 40; ++number) {
    const RandomScene scene = random_scene(number, 7);
    const ParallelView view = view_of(scene);
    const OpticalField field = optical_field(scene.content, scene.selection, view, true);
    const Ray ray = ray_through(view, field.grid, 0.5 * view.size.width, 0.47 * view.size.height);
    const RayRadiance exact = integrate_ray(field, ray);
    if (exact.transmittance > 0.999) continue;
    const double reach =
        2 * scene.content.display.radius_mm +
        std::abs(dot(minus(view.center_lps_mm, scene.content.display.center_lps_mm), view.forward_lps)) +
        10 * scene.content.source_grid.spacing_mm[0];
    const RayRadiance expected = brute_force(field, ray, -reach, reach, 100000);
    for (std::size_t c = 0; c < 3; ++c) {
      // The brute force errs by the square of its steps, 1e-4 to 1e-3 voxels, times the field's curvature.
      EXPECT_NEAR(exact.color[c], expected.color[c], 2e-8) << "scene " << number;
    }
    EXPECT_NEAR(exact.transmittance, expected.transmittance, 2e-8) << "scene " << number;
    ++compared;
  }
  EXPECT_GT(compared, 12);
}

/// A box of N voxels on a ray through their centres: partition of unity makes it N voxels of fog.
TEST(ReferenceVolume, ABoxIsAsLongAsItsVoxels) {
  OpticalField field;
  field.grid.size = {3, 9, 3};
  field.voxels.assign(81, {0.3, {0.3, 0.15, 0}});
  const Ray ray{{1, -7, 1}, {0, 1, 0}};
  const RayRadiance all = integrate_ray(field, ray);
  EXPECT_NEAR(all.transmittance, std::exp(-0.3 * 9), 1e-13);
  EXPECT_NEAR(all.color[0], -std::expm1(-0.3 * 9), 1e-13);
  EXPECT_NEAR(all.color[1], -0.5 * std::expm1(-0.3 * 9), 1e-13);
  // From the middle of the fog on, and the rise from 0 to 1 over the first voxel alone.
  EXPECT_NEAR(integrate_ray(field, ray, 7 + 4, kInfinity).transmittance, std::exp(-0.3 * 4.5), 1e-13);
  EXPECT_NEAR(integrate_ray(field, ray, 6, 7).transmittance, std::exp(-0.3 * 0.5), 1e-13);
  EXPECT_NEAR(integrate_ray(field, ray, 6, 6.25).transmittance, std::exp(-0.3 * 0.25 * 0.25 / 2), 1e-13);
}

}  // namespace
}  // namespace splatlas::reference
