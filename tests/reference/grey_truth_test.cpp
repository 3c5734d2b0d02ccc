#include "tests/reference/grey_truth.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "format/content/unit_vector.h"
#include "tests/reference/reference_volume.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = HUGE_VAL;

MaskedVolume random_volume(std::mt19937& random) {
  MaskedVolume volume;
  volume.grid.size = {7, 5, 6};
  std::uniform_int_distribution<int> grey(0, 255);
  std::bernoulli_distribution selected(0.6);
  for (std::int64_t n = 0; n < volume.grid.voxels(); ++n) {
    volume.greys.push_back(selected(random) ? static_cast<std::uint8_t>(grey(random)) : std::uint8_t{0});
  }
  return volume;
}

/// Random normals for half of the selected voxels.
void add_normals(std::mt19937& random, MaskedVolume& volume) {
  std::uniform_int_distribution<std::int32_t> normal(0, 65535);
  std::bernoulli_distribution lit(0.5);
  for (const std::uint8_t grey : volume.greys) {
    volume.normals.push_back(grey == 0     ? MaskedVolume::kOutside
                             : lit(random) ? normal(random)
                                           : MaskedVolume::kUnlit);
  }
}

ParallelView oblique_view() {
  return *parallel_view({.azimuth_deg = 40, .elevation_deg = 25}, {8, 8}, {});
}

/// Factor of a voxel's emission.
double factor_of(const MaskedVolume& volume, std::size_t voxel, const ParallelView& view) {
  if (volume.normals[voxel] < 0) return 1;
  const auto normal = unpack_normal(static_cast<PackedNormal>(volume.normals[voxel]));
  return diffuse(view, {normal[0], normal[1], normal[2]});
}

/// A ramp, a plateau, a step down and a step up.
GreyAppearance stepped_appearance() {
  return {{{20, 0, {0.1, 0.2, 0.3}},
           {90, 0.8, {1, 0.5, 0.2}},
           {120, 0.8, {0.2, 0.5, 1}},
           {120, 0.1, {0.2, 0.5, 1}},
           {200, 0.1, {1, 1, 1}},
           {200, 3, {1, 0, 1}}}};
}

Ray random_ray(std::mt19937& random) {
  std::uniform_real_distribution<double> place(0.5, 4.5), direction(-1, 1);
  Ray ray;
  double length = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    ray.start[a] = place(random);
    ray.per_mm[a] = direction(random);
    length += ray.per_mm[a] * ray.per_mm[a];
  }
  for (double& step : ray.per_mm) step /= std::sqrt(length);
  return ray;
}

VoxelOptics optics_at(const GreyAppearance& appearance, double grey) {
  const GreyAppearance::Knot knot = appearance.at(grey);
  return optics_of({knot.extinction_per_mm, 1}, knot.color);
}

/// Hybrid shading, in the last 20 cases: the emission of lit voxels is multiplied before interpolation.
TEST(GreyTruth, ClassifiedBeforehandEqualsTheOtherReference) {
  std::mt19937 random(1);
  const ParallelView view = oblique_view();
  for (int n = 0; n < 70; ++n) {
    const bool is_lit = n >= 50;
    MaskedVolume volume = random_volume(random);
    if (is_lit) add_normals(random, volume);
    const GreyAppearance appearance = stepped_appearance();
    OpticalField field{volume.grid, {}};
    for (std::size_t voxel = 0; voxel < volume.greys.size(); ++voxel) {
      VoxelOptics optics = optics_at(appearance, volume.greys[voxel]);
      for (double& emission : optics.emission) emission *= is_lit ? factor_of(volume, voxel, view) : 1;
      field.voxels.push_back(optics);
    }
    const Ray ray = random_ray(random);
    const double from_mm = n % 2 == 0 ? -kInfinity : 0;
    const RayRadiance expected = integrate_ray(field, ray, from_mm, kInfinity);
    const RayRadiance radiance =
        GreyTruth(volume, appearance, Classification::kBefore, is_lit ? &view : nullptr).along(ray, from_mm);
    EXPECT_NEAR(radiance.transmittance, expected.transmittance, 2e-7);
    // Random factors bend the colour within a cell, where the two references place their nodes differently.
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(radiance.color[c], expected.color[c], is_lit ? 2e-6 : 2e-7);
  }
}

/// The colour is multiplied by the mean factor of the selected voxels around, weighted as grey values are.
TEST(GreyTruth, LightsPostclassifiedColours) {
  std::mt19937 random(6);
  const ParallelView view = oblique_view();
  for (int n = 0; n < 20; ++n) {
    MaskedVolume volume = random_volume(random);
    add_normals(random, volume);
    const GreyAppearance appearance = stepped_appearance();
    const Ray ray = random_ray(random);
    constexpr int kSteps = 100000;
    constexpr double kReach = 12;
    const double step_mm = 2 * kReach / kSteps;
    RayRadiance expected;
    for (int step = 0; step < kSteps; ++step) {
      double grey = 0, factor = 0, members = 0;
      for_each_corner(ray.at(-kReach + (step + 0.5) * step_mm), [&](const Index3& corner, double weight) {
        grey += weight * volume.at(corner[0], corner[1], corner[2]);
        if (!volume.grid.contains(corner[0], corner[1], corner[2])) return;
        const auto voxel = static_cast<std::size_t>(volume.grid.offset(corner[0], corner[1], corner[2]));
        if (volume.normals[voxel] == MaskedVolume::kOutside) return;
        factor += weight * factor_of(volume, voxel, view);
        members += weight;
      });
      VoxelOptics optics = optics_at(appearance, grey);
      if (members > 0) {
        for (double& emission : optics.emission) emission *= factor / members;
      }
      expected.add(slab(optics, step_mm));
    }
    const RayRadiance radiance =
        GreyTruth(volume, appearance, Classification::kAfter, &view).along(ray, -kInfinity);
    // As below: each of a few dozen steps of the appearance is off by 2e-4 mm in the brute force.
    EXPECT_NEAR(radiance.transmittance, expected.transmittance, 6e-4);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(radiance.color[c], expected.color[c], 6e-4);
  }
}

TEST(GreyTruth, ClassifiedAfterwardsEqualsBruteForce) {
  std::mt19937 random(2);
  for (int n = 0; n < 50; ++n) {
    const MaskedVolume volume = random_volume(random);
    const GreyAppearance appearance = stepped_appearance();
    const Ray ray = random_ray(random);
    constexpr int kSteps = 200000;
    constexpr double kReach = 12;
    const double start = n % 2 == 0 ? -kReach : 0;
    const double step_mm = (kReach - start) / kSteps;
    RayRadiance expected;
    for (int step = 0; step < kSteps; ++step) {
      double grey = 0;
      for_each_corner(ray.at(start + (step + 0.5) * step_mm), [&](const Index3& corner, double weight) {
        grey += weight * volume.at(corner[0], corner[1], corner[2]);
      });
      expected.add(slab(optics_at(appearance, grey), step_mm));
    }
    const RayRadiance radiance =
        GreyTruth(volume, appearance, Classification::kAfter).along(ray, n % 2 == 0 ? -kInfinity : 0);
    // Each of a few dozen steps of the appearance is off by 1e-4 mm in the brute force.
    EXPECT_NEAR(radiance.transmittance, expected.transmittance, 3e-4);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(radiance.color[c], expected.color[c], 3e-4);
  }
}

/// A box of n voxels of grey g in an empty volume, on a row through their centres. Pre-classification gives n
/// mm of full extinction. Post-classification with a step at g/2 places the border midway between voxels: n
/// mm again. With the step at g/4 it lies a quarter voxel further out on both sides.
TEST(GreyTruth, ABoxIsAsLongAsItsClassificationSays) {
  MaskedVolume volume;
  volume.grid.size = {12, 3, 3};
  volume.greys.assign(108, 0);
  for (std::int64_t i = 3; i < 8; ++i) {
    for (std::int64_t n = 0; n < 9; ++n) volume.greys[static_cast<std::size_t>(n * 12 + i)] = 200;
  }
  const auto depth = [&](double step_at, Classification classification) {
    const GreyAppearance appearance{{{step_at, 0, {1, 1, 1}}, {step_at, 0.2, {1, 1, 1}}}};
    const Ray ray{{0, 1, 1}, {1, 0, 0}};
    const RayRadiance radiance = GreyTruth(volume, appearance, classification).along(ray, -kInfinity);
    EXPECT_NEAR(radiance.color[0], 1 - radiance.transmittance, 1e-9);
    return -std::log(radiance.transmittance);
  };
  EXPECT_NEAR(depth(100, Classification::kBefore), 0.2 * 5, 1e-9);
  EXPECT_NEAR(depth(100, Classification::kAfter), 0.2 * 5, 1e-9);
  EXPECT_NEAR(depth(50, Classification::kAfter), 0.2 * 5.5, 1e-9);
}

/// Grey values rise by 20 per voxel. Extinction is proportional, so that the optical depth is quadratic.
TEST(GreyTruth, ARampIsIntegratedExactly) {
  MaskedVolume volume;
  volume.grid.size = {11, 2, 2};
  for (int n = 0; n < 44; ++n) volume.greys.push_back(static_cast<std::uint8_t>(20 * (n % 11)));
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {200, 1, {1, 1, 1}}}};
  for (const Classification c : {Classification::kBefore, Classification::kAfter}) {
    const GreyTruth truth(volume, appearance, c);
    const Ray ray{{0, 0.5, 0.5}, {1, 0, 0}};
    // A ramp of 10 mm up to 1/mm, then 1 mm down to 0.
    EXPECT_NEAR(-std::log(truth.along(ray, -kInfinity).transmittance), 5 + 0.5, 1e-9);
    // From the eye on, here in the middle of the ramp.
    EXPECT_NEAR(-std::log(truth.along(ray, 5).transmittance), 5 - 1.25 + 0.5, 1e-9);
  }
}

/// The eye in the middle of a cube of 21 voxels of fog, looking along an axis: 10.5 voxels lie ahead. The
/// rays of other pixels cross the plane of the picture at their pixel.
TEST(GreyTruth, AnEyeInsideSeesWhatLiesAhead) {
  MaskedVolume volume;
  volume.grid.size = {21, 21, 21};
  volume.grid.origin_lps_mm = {-10, -10, -10};
  volume.greys.assign(21 * 21 * 21, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, 0.05, {1, 1, 1}}}};
  const Camera camera{.azimuth_deg = 90};
  PerspectiveView view{*parallel_view(camera, {33, 33}, {.center_lps_mm = {-6, 0, 0}, .radius_mm = 4}), 60};
  // The eye is at distance_mm() from the centre, on the left (+x): move it to the centre of the grid.
  view.in_plane.center_lps_mm = {-view.distance_mm(), 0, 0};
  EXPECT_NEAR(view.eye_lps_mm()[0], 0, 1e-12);
  for (const Classification c : {Classification::kBefore, Classification::kAfter}) {
    const ReferencePicture picture =
        render_grey_truth(GreyTruth(volume, appearance, c), volume.grid, view, 1);
    EXPECT_NEAR(picture.pixels[16 * 33 + 16][3], 1 - std::exp(-0.05 * 10.5), 1e-9);
    EXPECT_NEAR(picture.pixels[16 * 33 + 16][0], 1 - std::exp(-0.05 * 10.5), 1e-9);
  }
  const double half_height_mm = 0.5 * 33 * view.in_plane.mm_per_pixel;
  EXPECT_NEAR(half_height_mm / view.distance_mm(), std::tan(std::numbers::pi / 6), 1e-12);
  const Ray ray = ray_through(view, volume.grid, 33, 16.5);  // the middle of the right edge
  EXPECT_NEAR(-ray.per_mm[0], std::cos(std::numbers::pi / 6), 1e-12);
  EXPECT_NEAR(ray.per_mm[1], std::sin(std::numbers::pi / 6), 1e-12);  // right is posterior (+y)
}

}  // namespace
}  // namespace splatlas::reference
