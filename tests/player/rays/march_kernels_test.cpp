#include "player/rays/march_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "player/rays/brick_sums.h"
#include "tests/support/every_kernel.h"

namespace splatlas {
namespace {

/// What random voxels there are.
struct Shape {
  std::array<std::int32_t, 3> size{13, 11, 14};  ///< the margin of two included
  std::uint32_t one_of = 3;                      ///< so many voxels is dark,
  bool sparse = false;                           ///< or is not
  std::optional<std::size_t> gaps_along{};       ///< axis along which two thirds are dark,
  std::int32_t gaps = 20;                        ///< after so many voxels that are not
};

/// Random voxels in a box, as bytes, floats, colours and light.
class RandomSources {
 public:
  explicit RandomSources(std::uint32_t seed, const Shape& shape = {}) : random_(seed) {
    grid_.size = shape.size;
    const auto voxels = static_cast<std::size_t>(shape.size[0] * shape.size[1] * shape.size[2]);
    cell_corners_.assign(voxels, 0);
    greys_.assign(voxels, 0);
    fours_.assign(4 * voxels, 0);
    light_ = fours_;
    BrickMask shown(grid_);
    const auto place = [&](int x, int y, int z) {
      return static_cast<std::size_t>((z * grid_.size[1] + y) * grid_.size[0] + x);
    };
    for (int z = 2; z < grid_.size[2] - 2; ++z) {
      for (int y = 2; y < grid_.size[1] - 2; ++y) {
        for (int x = 2; x < grid_.size[0] - 2; ++x) {
          if (shape.gaps_along && std::array{x, y, z}[*shape.gaps_along] / shape.gaps % 3 != 1) continue;
          if ((random_() % shape.one_of == 0) != shape.sparse) continue;
          const std::uint64_t grey = random_() % 256;
          greys_[place(x, y, z)] = static_cast<float>(grey);
          for (int n = 0; n < 8; ++n) {
            const int i = x - (n & 1), j = y - (n >> 1 & 1), k = z - (n >> 2);
            cell_corners_[place(i, j, k)] |= grey << (8 * n);
            constexpr int kBrick = MarchGrid::kBrick;
            shown.bricks[shown.number(i / kBrick, j / kBrick, k / kBrick)] = 1;
          }
          for (std::size_t c = 0; c < 4; ++c) {
            const float share = static_cast<float>(random_() % 1000) / 1000;
            const std::size_t at = 4 * place(x, y, z);
            fours_[at + c] = c == 3 ? 1 : share;
            light_[at + c] = c == 0 ? share : share * light_[at];
          }
        }
      }
    }
    active_ = brick_sums(shown);
  }

  /// Of opacities up to 0.9, or a share of that.
  PreintegratedTransfer curve(std::size_t points, float share = 1) {
    TransferCurve curve;
    for (std::size_t n = 0; n < points; ++n) {
      curve.points.push_back({20.0 + 200.0 * static_cast<double>(n) / static_cast<double>(points),
                              n == 0 ? 0.0f : share * static_cast<float>(random_() % 90) / 100,
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

  /// Each along an axis of its own.
  RayPacket rays_of_all_axes() {
    RayPacket packet;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float sign = random_() % 2 == 0 ? 1.0f : -1.0f;
      place_ray(packet, n, random_() % 3, sign, {part(), part(), part()}, {slope(), slope(), slope()});
    }
    return packet;
  }
  /// Each all but along a diagonal of cells, from next to one edge of a cell to next to the opposite one.
  RayPacket diagonals() {
    RayPacket packet;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const std::size_t axis = random_() % 3;
      const float sign = random_() % 2 == 0 ? 1.0f : -1.0f;
      place_ray(packet, n, axis, sign, {0, 0, 0}, {0, 0, 0});
      const float middle = std::floor(static_cast<float>(grid_.size[axis]) / 2);
      bool near_end = random_() % 2 == 0;
      for (std::size_t a = 0; a < 3; ++a) {
        if (a == axis) continue;
        const float slope = (random_() % 2 == 0 ? 1.0f : -1.0f) * (1 - 0.1f * part());
        const float whole = std::floor(3 + part() * static_cast<float>(grid_.size[a] - 6));
        const float at = whole + (near_end == (slope > 0) ? 1 - 0.1f * part() : 0.1f * part());
        packet.step[a][n] = slope;
        packet.origin[a][n] = at - slope * middle * sign;
        near_end = !near_end;
      }
    }
    return packet;
  }
  /// Side by side, as those of a few pixels are.
  RayPacket bundle(std::size_t axis, float max_slope) {
    RayPacket packet;
    const float sign = random_() % 2 == 0 ? 1.0f : -1.0f;
    const std::array places{part(), part(), part()};
    const std::array slopes{slope() * max_slope, slope() * max_slope, slope() * max_slope};
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      std::array own_places = places, own_slopes = slopes;
      for (std::size_t a = 0; a < 3; ++a) {
        own_places[a] = std::min(own_places[a] + 0.1f * part(), 1.0f);
        own_slopes[a] += 0.01f * slope();
      }
      place_ray(packet, n, axis, sign, own_places, own_slopes);
    }
    return packet;
  }

  MarchSource cell_corners(const PreintegratedTransfer& curve) const {
    MarchSource source;
    source.cell_corners = cell_corners_.data();
    source.curve = &curve;
    source.color = {0.9f, 0.5f, 0.1f};
    source.active = active_.data();
    return source;
  }
  MarchSource greys(const PreintegratedTransfer& curve) const {
    MarchSource source = cell_corners(curve);
    source.cell_corners = nullptr;
    source.greys = greys_.data();
    return source;
  }
  MarchSource colored(const PreintegratedTransfer& curve) const {
    MarchSource source = cell_corners(curve);
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
            .min_steps = steps,
            .max_steps = steps};
  }

 private:
  float part() { return static_cast<float>(random_() % 1000) / 1000; }
  float slope() { return 2 * part() - 1; }
  /// Through a place of the plane half-way along `axis`, as a share of the voxels.
  void place_ray(RayPacket& packet, std::size_t n, std::size_t axis, float sign,
                 const std::array<float, 3>& place, const std::array<float, 3>& slopes) {
    const float middle = static_cast<float>(grid_.size[axis]) / 2;
    for (std::size_t a = 0; a < 3; ++a) {
      packet.step[a][n] = a == axis ? sign : slopes[a];
      const float at = 2 + place[a] * static_cast<float>(grid_.size[a] - 4);
      packet.origin[a][n] = a == axis ? 0 : at - slopes[a] * middle * sign;
    }
    packet.mm_per_t[n] = 0.5f + part();
    packet.from[n] = -1e9f;
    packet.to[n] = 1e9f;
  }

  std::mt19937 random_;
  MarchGrid grid_;
  std::vector<std::uint64_t> cell_corners_;
  std::vector<float> greys_, fours_, light_;
  std::vector<std::uint32_t> active_;
};

/// How far both are apart.
struct Difference {
  float largest = 0;
  double squares = 0;
};

/// For packets that start with light already.
Difference difference(const MarchScene& scene, const RayPacket& rays, const MarchKernels& a,
                      const MarchKernels& b) {
  RadiancePacket of_a, of_b;
  for (std::size_t n = 0; n < kPacketRays; n += 2) {
    of_a.planes[3][n] = of_b.planes[3][n] = 0.5f;
    of_a.planes[1][n] = of_b.planes[1][n] = 0.25f;
  }
  a.march(scene, rays, of_a);
  b.march(scene, rays, of_b);
  Difference found;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      EXPECT_TRUE(std::isfinite(of_a.planes[c][n]));
      const float apart = std::abs(of_a.planes[c][n] - of_b.planes[c][n]);
      found.largest = std::max(found.largest, apart);
      found.squares += std::pow(apart, 2) / (4 * kPacketRays);
    }
  }
  return found;
}

/// All kinds of sources, and several together.
std::vector<std::vector<MarchSource>> all_kinds(const RandomSources& random,
                                                const PreintegratedTransfer& curve,
                                                const PreintegratedTransfer& other) {
  return {{random.cell_corners(curve)},
          {random.greys(curve)},
          {random.colored(curve)},
          {random.light()},
          {random.cell_corners(curve), random.greys(other), random.light(), random.colored(other)}};
}

class MarchKernelsOf : public EveryKernel {
 protected:
  [[nodiscard]] static const MarchKernels& kernels() {
    return is_reference() ? scalar_march() : best_march();
  }
};
INSTANTIATE_TEST_SUITE_P(Every, MarchKernelsOf, testing::ValuesIn(targets_and_reference()), kernel_name);

TEST_P(MarchKernelsOf, AgreeWithTheScalarTwin) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    RandomSources random(seed);
    for (const std::size_t points : {2u, 4u, 9u, 30u, 256u}) {
      const PreintegratedTransfer curve = random.curve(points), other = random.curve(3);
      for (const RayPacket& rays : {random.rays(), random.rays_of_all_axes()}) {
        const auto cases = all_kinds(random, curve, other);
        for (std::size_t n = 0; n < cases.size(); ++n) {
          for (const int steps : {1, 3}) {
            EXPECT_LE(difference(random.scene(cases[n], steps), rays, kernels(), scalar_march()).largest,
                      2e-5f)
                << "seed " << seed << ", " << points << " points, case " << n << ", " << steps << " steps";
          }
        }
      }
    }
  }
}

/// Along lines of few bricks with long empty ways between them; the scalar twin passes over nothing.
TEST_P(MarchKernelsOf, PassOverEmptyBricksOnly) {
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    const std::size_t axis = seed % 3;
    Shape shape{.one_of = seed % 2 == 0 ? 3u : 400u,
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
          EXPECT_LE(difference(random.scene(cases[n], steps), rays, kernels(), scalar_march()).largest, 2e-5f)
              << "seed " << seed << ", case " << n << ", " << steps << " steps";
        }
      }
    }
  }
}

/// What march_kernels.h promises where there is a tolerance: the rays of a vector take the steps that any of
/// them needs, the twin's what each of them needs itself.
TEST_P(MarchKernelsOf, AgreeWithTheScalarTwinWithinTheTolerance) {
  for (const float tolerance : {0.054f, 0.0046f}) {
    float largest = 0;
    double squares = 0, packets = 0;
    for (std::uint32_t seed = 0; seed < 120; ++seed) {
      RandomSources random(seed, {.one_of = seed % 2 == 0 ? 3u : 30u, .sparse = seed % 2 != 0});
      const PreintegratedTransfer curve = random.curve(2 + seed % 5), other = random.curve(3);
      const RayPacket rays = seed % 3 == 0 ? random.diagonals() : random.rays_of_all_axes();
      for (const std::vector<MarchSource>& sources : all_kinds(random, curve, other)) {
        MarchScene scene = random.scene(sources, 1);
        scene.tolerance = tolerance;
        scene.max_steps = 32;
        const Difference found = difference(scene, rays, kernels(), scalar_march());
        largest = std::max(largest, found.largest);
        squares += found.squares;
        ++packets;
      }
    }
    EXPECT_LE(largest, 4 * tolerance);
    EXPECT_LE(std::sqrt(squares / packets), 0.1 * static_cast<double>(tolerance));
  }
}

/// Bytes and floats are the same volume.
TEST_P(MarchKernelsOf, BytesAreAsGoodAsFloats) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const PreintegratedTransfer curve = random.curve(5);
    const RayPacket rays = random.rays();
    const std::vector bytes{random.cell_corners(curve)}, floats{random.greys(curve)};
    RadiancePacket of_bytes, of_floats;
    kernels().march(random.scene(bytes, 2), rays, of_bytes);
    kernels().march(random.scene(floats, 2), rays, of_floats);
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        EXPECT_NEAR(of_bytes.planes[c][n], of_floats.planes[c][n], 2e-5) << seed;
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
    RadiancePacket light;
    kernels().march(scene, rays, light);
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      EXPECT_NEAR(light.planes[0][n], expected, 1e-5) << "forward: " << forward;
      EXPECT_NEAR(light.planes[3][n], 1 - clear, 1e-5);
    }
  }
}

/// Cut cell by cell and halved, grey values are exact: a tolerance next to nothing is as good as very many
/// steps, for rays that begin and end anywhere, too.
TEST_P(MarchKernelsOf, CutCellsConverge) {
  double squares = 0, rays_compared = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const PreintegratedTransfer curve = random.curve(2);
    const std::vector sources{random.cell_corners(curve)};
    RayPacket rays = random.rays();
    RadiancePacket light[2];
    kernels().march(random.scene(sources, 64), rays, light[0]);
    MarchScene scene = random.scene(sources, 1);
    scene.tolerance = 1e-5f;
    kernels().march(scene, rays, light[1]);
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      squares += std::pow(light[1].planes[3][n] - light[0].planes[3][n], 2);
      ++rays_compared;
    }
  }
  EXPECT_LT(std::sqrt(squares / rays_compared), 5e-5);
}

/// A tolerance takes more steps where they are needed: the picture comes as close to the one of many steps.
TEST_P(MarchKernelsOf, ToleranceBoundsWhatIsWrong) {
  double coarse = 0, adapted = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RandomSources random(seed);
    const PreintegratedTransfer curve = random.curve(4);
    const std::vector sources{random.cell_corners(curve)};
    const RayPacket rays = random.rays();
    RadiancePacket light[3];
    kernels().march(random.scene(sources, 64), rays, light[0]);
    kernels().march(random.scene(sources, 1), rays, light[1]);
    MarchScene scene = random.scene(sources, 1);
    scene.tolerance = 0.01f;
    scene.max_steps = 64;
    kernels().march(scene, rays, light[2]);
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      coarse += std::pow(light[1].planes[3][n] - light[0].planes[3][n], 2);
      adapted += std::pow(light[2].planes[3][n] - light[0].planes[3][n], 2);
    }
  }
  const double rays = 20 * kPacketRays;
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

/// Between both ends of a slab a ray may pass cells that neither end is in.
TEST_P(MarchKernelsOf, ToleranceSeesCellsBetweenTheEndsOfASlab) {
  constexpr float kTolerance = 0.02f;
  std::array<float, 4> worst{};
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    RandomSources random(seed, {.one_of = 30, .sparse = true});
    TransferCurve steep;
    const double knot = seed % 2 == 0 ? 30 : 8;
    steep.points = {{knot, 0, 1}, {1.3 * knot, 0.9f, 1}};
    const PreintegratedTransfer curve(steep, {.bytes = true}, 1);
    const std::vector<MarchSource> kinds{random.cell_corners(curve), random.greys(curve),
                                         random.colored(curve), random.light()};
    const std::array all_rays{random.rays(), random.rays_of_all_axes(), random.diagonals()};
    for (std::size_t n = 0; n < 3 * kPacketRays; ++n) {
      const RayPacket ray = lone(all_rays[n / kPacketRays], n % kPacketRays);
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        const std::vector sources{kinds[kind]};
        RadiancePacket truth;
        scalar_march().march(random.scene(sources, 64), ray, truth);
        MarchScene scene = random.scene(sources, 1);
        scene.tolerance = kTolerance;
        scene.max_steps = 64;
        RadiancePacket light;
        kernels().march(scene, ray, light);
        worst[kind] = std::max(worst[kind], std::abs(light.planes[3][0] - truth.planes[3][0]));
      }
    }
  }
  for (const float error : worst) EXPECT_LT(error, 4 * kTolerance);
}

}  // namespace
}  // namespace splatlas
