#include "player/march_kernels.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "player/brick_sums.h"

namespace splatlas {
namespace {

/// Random voxels in a box, as bytes, floats, colours and light.
class RandomSources {
 public:
  /// A third of the voxels are dark; where `sparse`, all but one of thirty.
  explicit RandomSources(std::uint32_t seed, bool sparse = false) : random_(seed) {
    grid_.size = {13, 11, 14};
    const auto voxels = static_cast<std::size_t>(13 * 11 * 14);
    octants_.assign(voxels, 0);
    greys_.assign(voxels, 0);
    fours_.assign(4 * voxels, 0);
    light_ = fours_;
    const auto place = [&](int x, int y, int z) {
      return static_cast<std::size_t>((z * grid_.size[1] + y) * grid_.size[0] + x);
    };
    for (int z = 2; z < 12; ++z) {
      for (int y = 2; y < 9; ++y) {
        for (int x = 2; x < 11; ++x) {
          if (sparse ? random_() % 30 != 0 : random_() % 3 == 0) continue;
          const std::uint64_t grey = random_() % 256;
          greys_[place(x, y, z)] = static_cast<float>(grey);
          for (int n = 0; n < 8; ++n) {
            octants_[place(x - (n & 1), y - (n >> 1 & 1), z - (n >> 2))] |= grey << (8 * n);
          }
          for (std::size_t c = 0; c < 4; ++c) {
            const float share = static_cast<float>(random_() % 1000) / 1000;
            const std::size_t at = 4 * place(x, y, z);
            fours_[at + c] = share;
            light_[at + c] = c == 0 ? share : share * light_[at];
          }
        }
      }
    }
    BrickMask all(grid_);
    std::fill(all.bricks.begin(), all.bricks.end(), std::uint8_t{1});
    active_ = brick_sums(all);
  }

  GreyCurve curve(std::size_t points) {
    TransferCurve curve;
    for (std::size_t n = 0; n < points; ++n) {
      curve.points.push_back({20.0 + 200.0 * static_cast<double>(n) / static_cast<double>(points),
                              n == 0 ? 0.0f : static_cast<float>(random_() % 90) / 100,
                              static_cast<float>(random_() % 100) / 100});
    }
    return {curve, {.bytes = true}, 1};
  }

  RayPacket rays() {
    RayPacket packet;
    std::uniform_real_distribution<float> place(2, 10), slope(-1, 1);
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float sign = random_() % 2 == 0 ? 1.0f : -1.0f;
      packet.step[2][n] = sign;
      for (const std::size_t a : {0u, 1u}) {
        packet.step[a][n] = slope(random_);
        packet.origin[a][n] = place(random_) - packet.step[a][n] * 6 * sign;
      }
      packet.mm_per_t[n] = 0.5f + std::abs(slope(random_));
      packet.from[n] = random_() % 3 == 0 ? sign * place(random_) : -1e9f;
      packet.to[n] = random_() % 3 == 0 ? packet.from[n] + 3 : 1e9f;
    }
    return packet;
  }

  MarchSource octants(const GreyCurve& curve) const {
    MarchSource source;
    source.octants = octants_.data();
    source.curve = &curve;
    source.color = {0.9f, 0.5f, 0.1f};
    source.active = active_.data();
    return source;
  }
  MarchSource greys(const GreyCurve& curve) const {
    MarchSource source = octants(curve);
    source.octants = nullptr;
    source.greys = greys_.data();
    return source;
  }
  MarchSource colored(const GreyCurve& curve) const {
    MarchSource source = octants(curve);
    source.colors = fours_.data();
    return source;
  }
  MarchSource light() const {
    MarchSource source;
    source.light = light_.data();
    source.active = active_.data();
    return source;
  }
  MarchScene scene(std::span<const MarchSource> sources, int steps) const {
    return {.grid = grid_,
            .sources = sources,
            .active = active_.data(),
            .floor = 0,
            .least_steps = steps,
            .most_steps = steps};
  }

 private:
  std::mt19937 random_;
  MarchGrid grid_;
  std::vector<std::uint64_t> octants_;
  std::vector<float> greys_, fours_, light_;
  std::vector<std::uint32_t> active_;
};

/// The largest difference, to values that the packet may start with.
float difference(const MarchScene& scene, const RayPacket& rays, const MarchKernels& a,
                 const MarchKernels& b) {
  LightPacket of_a, of_b;
  for (std::size_t n = 0; n < kPacketRays; n += 2) {
    of_a.planes[3][n] = of_b.planes[3][n] = 0.5f;
    of_a.planes[1][n] = of_b.planes[1][n] = 0.25f;
  }
  a.march(scene, rays, of_a);
  b.march(scene, rays, of_b);
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      EXPECT_TRUE(std::isfinite(of_a.planes[c][n]));
      largest = std::max(largest, std::abs(of_a.planes[c][n] - of_b.planes[c][n]));
    }
  }
  return largest;
}

TEST(MarchKernels, VectorsAgreeWithTheScalarTwin) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    RandomSources random(seed);
    for (const std::size_t points : {2u, 4u, 9u, 30u}) {
      const GreyCurve curve = random.curve(points), other = random.curve(3);
      const RayPacket rays = random.rays();
      const std::vector<std::vector<MarchSource>> cases{
          {random.octants(curve)},
          {random.greys(curve)},
          {random.colored(curve)},
          {random.light()},
          {random.octants(curve), random.greys(other), random.light(), random.colored(other)}};
      for (std::size_t n = 0; n < cases.size(); ++n) {
        for (const int steps : {1, 3}) {
          EXPECT_LE(difference(random.scene(cases[n], steps), rays, best_march(), scalar_march()), 2e-5f)
              << "seed " << seed << ", " << points << " points, case " << n << ", " << steps << " steps";
        }
      }
    }
  }
}

/// Bytes and floats are the same volume.
TEST(MarchKernels, BytesAreAsGoodAsFloats) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const GreyCurve curve = random.curve(5);
    const RayPacket rays = random.rays();
    const std::vector bytes{random.octants(curve)}, floats{random.greys(curve)};
    LightPacket of_bytes, of_floats;
    best_march().march(random.scene(bytes, 2), rays, of_bytes);
    best_march().march(random.scene(floats, 2), rays, of_floats);
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        EXPECT_NEAR(of_bytes.planes[c][n], of_floats.planes[c][n], 2e-5) << seed;
      }
    }
  }
}

/// A slab of one depth, with a colour that changes in proportion to the share of the depth passed: the
/// integral in closed form, however few steps there are.
TEST(MarchKernels, WhatIsEmittedInFrontHidesWhatIsBehind) {
  // Grey values from 0 to 200 along x, of a constant extinction and a shade from 0 to 1.
  MarchGrid grid;
  grid.size = {8, 8, 8};
  constexpr float kOpacity = 0.9f;
  const GreyCurve curve({{{0, kOpacity, 0}, {200, kOpacity, 1}}}, {.bytes = true}, 1);
  std::vector<std::uint64_t> octants(512, 0);
  for (std::size_t n = 0; n < octants.size(); ++n) {
    const std::uint64_t x = n % 8;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      octants[n] |= std::min<std::uint64_t>(25 * (x + corner % 2), 200) << (8 * corner);
    }
  }
  BrickMask all(grid);
  std::fill(all.bricks.begin(), all.bricks.end(), std::uint8_t{1});
  const std::vector<std::uint32_t> active = brick_sums(all);
  MarchSource source;
  source.octants = octants.data();
  source.curve = &curve;
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
    for (const MarchKernels* kernels : {&scalar_march(), &best_march()}) {
      LightPacket light;
      kernels->march(scene, rays, light);
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        EXPECT_NEAR(light.planes[0][n], expected, 1e-5) << kernels->name << ", forward: " << forward;
        EXPECT_NEAR(light.planes[3][n], 1 - clear, 1e-5) << kernels->name;
      }
    }
  }
}

/// Cut cell by cell and halved, grey values are exact: a tolerance next to nothing is as good as very many
/// steps, for rays that begin and end anywhere, too.
TEST(MarchKernels, CutCellsConverge) {
  double squares = 0, rays_compared = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const GreyCurve curve = random.curve(2);
    const std::vector sources{random.octants(curve)};
    RayPacket rays = random.rays();
    for (const MarchKernels* kernels : {&scalar_march(), &best_march()}) {
      LightPacket light[2];
      kernels->march(random.scene(sources, 64), rays, light[0]);
      MarchScene scene = random.scene(sources, 1);
      scene.tolerance = 1e-5f;
      kernels->march(scene, rays, light[1]);
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        squares += std::pow(light[1].planes[3][n] - light[0].planes[3][n], 2);
        ++rays_compared;
      }
    }
  }
  EXPECT_LT(std::sqrt(squares / rays_compared), 5e-5);
}

/// A tolerance takes more steps where they are needed: the picture comes as close to the one of many steps.
TEST(MarchKernels, ToleranceBoundsWhatIsWrong) {
  double coarse = 0, adapted = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const GreyCurve curve = random.curve(4);
    const std::vector sources{random.octants(curve)};
    const RayPacket rays = random.rays();
    for (const MarchKernels* kernels : {&scalar_march(), &best_march()}) {
      LightPacket light[3];
      kernels->march(random.scene(sources, 64), rays, light[0]);
      kernels->march(random.scene(sources, 1), rays, light[1]);
      MarchScene scene = random.scene(sources, 1);
      scene.tolerance = 0.01f;
      scene.most_steps = 64;
      kernels->march(scene, rays, light[2]);
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        coarse += std::pow(light[1].planes[3][n] - light[0].planes[3][n], 2);
        adapted += std::pow(light[2].planes[3][n] - light[0].planes[3][n], 2);
      }
    }
  }
  const double rays = 20 * 2 * kPacketRays;
  EXPECT_GT(std::sqrt(coarse / rays), 1e-2);
  EXPECT_LT(std::sqrt(adapted / rays), 5e-4);
}

/// One ray in all lanes: none has a neighbour that asks for more steps.
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

/// Between both ends of a slab a ray may pass a cell that neither end is in.
TEST(MarchKernels, ToleranceSeesCellsBetweenTheEndsOfASlab) {
  constexpr float kTolerance = 0.02f;
  float worst[2][4] = {};
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    RandomSources random(seed, true);
    TransferCurve steep;
    steep.points = {{30, 0, 1}, {40, 0.9f, 1}};
    const GreyCurve curve(steep, {.bytes = true}, 1);
    const std::vector<MarchSource> kinds{random.octants(curve), random.greys(curve), random.colored(curve),
                                         random.light()};
    const RayPacket rays = random.rays();
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const RayPacket ray = lone(rays, n);
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        const std::vector sources{kinds[kind]};
        LightPacket truth;
        scalar_march().march(random.scene(sources, 64), ray, truth);
        MarchScene scene = random.scene(sources, 1);
        scene.tolerance = kTolerance;
        scene.most_steps = 64;
        for (const bool best : {false, true}) {
          LightPacket light;
          (best ? best_march() : scalar_march()).march(scene, ray, light);
          float& most = worst[best ? 1 : 0][kind];
          most = std::max(most, std::abs(light.planes[3][0] - truth.planes[3][0]));
        }
      }
    }
  }
  for (auto& of_kernels : worst) {
    for (const float error : of_kernels) EXPECT_LT(error, 4 * kTolerance);
  }
}

}  // namespace
}  // namespace splatlas
