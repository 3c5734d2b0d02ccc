#include "player/render/rays/march_kernels.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "player/render/rays/volume/ray_volume.h"
#include "tests/player/render/rays/march_definition.h"
#include "tests/player/render/rays/random_sources.h"
#include "tests/support/every_kernel.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

/// Half of the rays begin with some radiance and opacity.
RadiancePacket initial_radiance() {
  RadiancePacket radiance;
  for (std::size_t n = 0; n < kPacketRays; n += 2) {
    radiance.planes[3][n] = 0.5f;
    radiance.planes[1][n] = 0.25f;
  }
  return radiance;
}

RadiancePacket marched(const MarchScene& scene, const RayPacket& rays, const MarchKernels& kernels) {
  RadiancePacket radiance = initial_radiance();
  kernels.march(scene, rays, radiance);
  return radiance;
}

RadiancePacket defined(const MarchScene& scene, const RayPacket& rays) {
  const RadiancePacket initial = initial_radiance();
  RadiancePacket radiance;
  for (std::size_t n = 0; n < kPacketRays; ++n) {
    std::array<double, 4> rgba{};
    for (std::size_t c = 0; c < 4; ++c) rgba[c] = static_cast<double>(initial.planes[c][n]);
    rgba = reference::march_definition(scene, rays, n, rgba);
    for (std::size_t c = 0; c < 4; ++c) radiance.planes[c][n] = static_cast<float>(rgba[c]);
  }
  return radiance;
}

/// NaN if any value is.
float max_difference(const RadiancePacket& a, const RadiancePacket& b) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float difference = std::abs(a.planes[c][n] - b.planes[c][n]);
      if (!(difference <= largest)) largest = difference;
    }
  }
  return largest;
}

/// All kinds of sources, and several together.
std::vector<std::vector<MarchSource>> all_kinds(const RandomSources& random,
                                                const PreintegratedTransfer& curve,
                                                const PreintegratedTransfer& other) {
  return {{random.cell_corners(curve)},
          {random.greys(curve)},
          {random.colored(curve)},
          {random.optics()},
          {random.cell_corners(curve), random.greys(other), random.optics(), random.colored(other)}};
}

class MarchKernelsOf : public EveryKernel {
 protected:
  [[nodiscard]] static MarchKernels kernels() { return is_reference() ? scalar_march() : best_march(); }
};
INSTANTIATE_TEST_SUITE_P(Every, MarchKernelsOf, testing::ValuesIn(targets_and_reference()), kernel_name);

TEST_P(MarchKernelsOf, ComputeTheDefinitionInEqualSteps) {
  for (std::uint32_t seed = 0; seed < repetitions(40); ++seed) {
    RandomSources random(seed);
    for (const std::size_t points : {2u, 4u, 9u, 30u, 256u}) {
      const PreintegratedTransfer curve = random.curve(points), other = random.curve(3);
      for (const RayPacket& rays : {random.rays(), random.rays_of_all_axes()}) {
        const auto cases = all_kinds(random, curve, other);
        for (std::size_t n = 0; n < cases.size(); ++n) {
          for (const int steps : {1, 3}) {
            const MarchScene scene = random.scene(cases[n], steps);
            EXPECT_LE(max_difference(marched(scene, rays, kernels()), defined(scene, rays)), 2e-5f)
                << "seed " << seed << ", " << points << " points, case " << n << ", " << steps << " steps";
          }
        }
      }
    }
  }
}

/// For ids and depths: the same bits as with emissions.
TEST_P(MarchKernelsOf, FindOpacitiesFromExtinctionsAlone) {
  RandomSources random(7);
  std::vector sources{random.optics()};
  MarchScene scene = random.scene(sources, 1);
  std::vector<float> alone;
  for (std::ptrdiff_t n = 0; n < scene.grid.size[0] * scene.grid.size[1] * scene.grid.size[2]; ++n)
    alone.push_back(sources[0].optics[4 * n]);
  for (const float tolerance : {0.0f, 0.02f}) {
    scene.tolerance = tolerance;
    scene.max_steps = 16;
    const RayPacket rays = random.rays_of_all_axes();
    sources[0] = random.optics();
    const RadiancePacket expected = marched(scene, rays, kernels());
    std::tie(sources[0].optics, sources[0].greys) = std::pair(nullptr, alone.data());
    EXPECT_EQ(marched(scene, rays, kernels()).planes[3], expected.planes[3]);
  }
}

/// Lines of few bricks with long gaps between them; the definition skips nothing.
TEST_P(MarchKernelsOf, SkipEmptyBricksOnly) {
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    const std::size_t axis = seed % 3;
    SourceShape shape{.one_of = seed % 2 == 0 ? 3u : 400u,
                      .sparse = seed % 2 != 0,
                      .gaps_along = axis,
                      .gaps = 14 + static_cast<std::int32_t>(seed / 3)};
    shape.size[axis] = 150 + static_cast<std::int32_t>(seed);
    RandomSources random(seed, shape);
    const PreintegratedTransfer curve = random.curve(4, 0.01f), other = random.curve(3, 0.01f);
    for (const float max_slope : {0.02f, 0.2f, 1.0f}) {
      const RayPacket rays = random.bundle(axis, max_slope);
      const auto cases = all_kinds(random, curve, other);
      for (std::size_t n = 0; n < cases.size(); ++n) {
        for (const int steps : {1, 2}) {
          const MarchScene scene = random.scene(cases[n], steps);
          EXPECT_LE(max_difference(marched(scene, rays, kernels()), defined(scene, rays)), 2e-5f)
              << "seed " << seed << ", case " << n << ", " << steps << " steps";
        }
      }
    }
  }
}

/// A slab of one depth, with a colour that changes in proportion to the share of the depth passed: the
/// integral in closed form, however few steps there are.
TEST_P(MarchKernelsOf, WhatIsEmittedInFrontHidesWhatIsBehind) {
  // Grey values from 0 to 200 along x, of a constant extinction and a shade from 0 to 1.
  MarchGrid grid;
  grid.size = {8, 8, 8};
  constexpr float kOpacity = 0.9f;
  const PreintegratedTransfer curve({{{0, kOpacity, 0}, {200, kOpacity, 1}}}, {.bytes = true}, 1);
  std::vector<std::uint64_t> cell_corners(512, 0);
  for (std::size_t n = 0; n < cell_corners.size(); ++n) {
    const std::uint64_t x = n % 8;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      cell_corners[n] |= std::min<std::uint64_t>(25 * (x + corner % 2), 200) << (8 * corner);
    }
  }
  BrickMask all(grid);
  std::fill(all.bricks.begin(), all.bricks.end(), std::uint8_t{1});
  const std::vector<std::uint32_t> active = brick_sums(all);
  MarchSource source;
  source.cell_corners = cell_corners.data();
  source.transfer = &curve;
  source.color = {1, 1, 1};
  source.active = active.data();
  const MarchScene scene{.grid = grid, .sources = {&source, 1}, .active = active.data()};
  for (const bool forward : {true, false}) {
    RayPacket rays;
    const float sign = forward ? 1.0f : -1.0f;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      rays.step[0][n] = sign;
      rays.origin[1][n] = rays.origin[2][n] = 3.25f;
      rays.mm_per_t[n] = 1;
      rays.from[n] = forward ? 2.0f : -5.0f;
      rays.to[n] = rays.from[n] + 3;
    }
    // Shade s0 + slope x over 3 mm of extinction k: the integral of k (s0 + slope x) exp(-k x).
    const double k = extinction_of(kOpacity, 1), slope = sign * 25.0 / 200, s0 = forward ? 0.25 : 0.625;
    const double clear = std::exp(-3 * k);
    const double expected = s0 * (1 - clear) + slope * ((1 - clear) / k - 3 * clear);
    RadiancePacket radiance;
    kernels().march(scene, rays, radiance);
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      EXPECT_NEAR(radiance.planes[0][n], expected, 1e-5) << "forward: " << forward;
      EXPECT_NEAR(radiance.planes[3][n], 1 - clear, 1e-5);
    }
  }
}

/// RMS error of opacities, or of the colours of voxels, against 64 steps per slab. `adjust` sets the options
/// of a scene of one step.
template <typename Adjust>
double rms_error(const MarchKernels& kernels, std::size_t points, const Adjust& adjust,
                 bool colored = false) {
  constexpr std::uint32_t kSeeds = 20;
  const std::size_t plane = colored ? 1 : 3;
  double squares = 0;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    RandomSources random(seed);
    const PreintegratedTransfer curve = random.curve(points);
    const std::vector sources{colored ? random.colored(curve) : random.cell_corners(curve)};
    const RayPacket rays = random.rays();
    const RadiancePacket truth = defined(random.scene(sources, 64), rays);
    MarchScene scene = random.scene(sources, 1);
    adjust(scene);
    const RadiancePacket radiance = marched(scene, rays, kernels);
    for (std::size_t n = 0; n < kPacketRays; ++n)
      squares += std::pow(radiance.planes[plane][n] - truth.planes[plane][n], 2);
  }
  return std::sqrt(squares / (kSeeds * kPacketRays));
}

/// Subdivided cells are exact in the limit: a tiny tolerance is as good as very many steps, also for rays
/// that begin and end within slabs.
TEST_P(MarchKernelsOf, SubdividedCellsConverge) {
  EXPECT_LT(rms_error(kernels(), 2, [](MarchScene& scene) { scene.tolerance = 1e-5f; }), 5e-5);
}

/// A tolerance adds steps as needed to come close to the truth.
TEST_P(MarchKernelsOf, ToleranceBoundsTheError) {
  EXPECT_GT(rms_error(kernels(), 4, [](MarchScene&) {}), 1e-2);
  const auto adaptive = [](MarchScene& scene) {
    scene.tolerance = 0.01f;
    scene.max_steps = 64;
  };
  EXPECT_LT(rms_error(kernels(), 4, adaptive), 5e-4);
  EXPECT_GT(rms_error(
                kernels(), 4, [](MarchScene&) {}, true),
            1e-2);
  EXPECT_LT(rms_error(kernels(), 4, adaptive, true), 6e-4);
}

/// One ray in all lanes: no neighbour asks for more steps.
RayPacket lone(const RayPacket& rays, std::size_t n) {
  RayPacket packet;
  for (std::size_t a = 0; a < 3; ++a) {
    packet.origin[a].fill(rays.origin[a][n]);
    packet.step[a].fill(rays.step[a][n]);
  }
  packet.mm_per_t.fill(rays.mm_per_t[n]);
  packet.from.fill(rays.from[n]);
  packet.to.fill(rays.to[n]);
  return packet;
}

/// A slab may cross cells that neither of its ends lies in.
TEST_P(MarchKernelsOf, ToleranceSeesCellsBetweenTheEndsOfASlab) {
  constexpr float kTolerance = 0.02f;
  std::array<double, 4> worst{};
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    RandomSources random(seed, {.one_of = 30, .sparse = true});
    TransferCurve steep;
    const double knot = seed % 2 == 0 ? 30 : 8;
    steep.points = {{knot, 0, 1}, {1.3 * knot, 0.9f, 1}};
    const PreintegratedTransfer curve(steep, {.bytes = true}, 1);
    const std::vector<MarchSource> kinds{random.cell_corners(curve), random.greys(curve),
                                         random.colored(curve), random.optics()};
    const std::array all_rays{random.rays(), random.rays_of_all_axes(), random.diagonals()};
    for (std::size_t n = 0; n < 3 * kPacketRays; ++n) {
      const RayPacket ray = lone(all_rays[n / kPacketRays], n % kPacketRays);
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        const std::vector sources{kinds[kind]};
        const double truth = reference::march_definition(random.scene(sources, 64), ray, 0, {0, 0, 0, 0})[3];
        MarchScene scene = random.scene(sources, 1);
        scene.tolerance = kTolerance;
        scene.max_steps = 64;
        RadiancePacket radiance;
        kernels().march(scene, ray, radiance);
        worst[kind] = std::max(worst[kind], std::abs(static_cast<double>(radiance.planes[3][0]) - truth));
      }
    }
  }
  for (const double error : worst) EXPECT_LT(error, 4 * static_cast<double>(kTolerance));
}

}  // namespace
}  // namespace splatlas
