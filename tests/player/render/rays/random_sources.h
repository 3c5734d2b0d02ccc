// Random sources, transfer functions and packets of rays for tests of ray marching.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "player/render/rays/march_kernels.h"
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

/// Distribution of random voxels.
struct SourceShape {
  std::array<std::int32_t, 3> size{13, 11, 14};  ///< padding of two included
  std::uint32_t one_of = 3;                      ///< one of so many voxels is empty,
  bool sparse = false;                           ///< or is not empty
  std::optional<std::size_t> gaps_along{};       ///< axis along which two thirds are empty,
  std::int32_t gaps = 20;                        ///< in intervals of so many voxels
};

/// Random voxels in a box, as bytes, floats, colours and optical properties.
class RandomSources {
 public:
  explicit RandomSources(std::uint32_t seed, const SourceShape& shape = {}) : random_(seed) {
    grid_.size = shape.size;
    const auto voxels = static_cast<std::size_t>(shape.size[0] * shape.size[1] * shape.size[2]);
    cell_corners_.assign(voxels, 0);
    greys_.assign(voxels, 0);
    fours_.assign(4 * voxels, 0);
    optics_ = fours_;
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
            optics_[at + c] = c == 0 ? share : share * optics_[at];
          }
        }
      }
    }
    active_ = brick_sums(shown);
  }

  /// Random transfer function with opacities up to 0.9 * `share`.
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

  /// Rays with a random principal axis each.
  RayPacket rays_of_all_axes() {
    RayPacket packet;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const float sign = random_() % 2 == 0 ? 1.0f : -1.0f;
      place_ray(packet, n, random_() % 3, sign, {part(), part(), part()}, {slope(), slope(), slope()});
    }
    return packet;
  }
  /// Rays close to diagonals of cells, from one edge of a cell to the opposite edge.
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
  /// Rays side by side, as those of neighbouring pixels.
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
    source.transfer = &curve;
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
  MarchSource optics() const {
    MarchSource source;
    source.optics = optics_.data();
    source.active = active_.data();
    return source;
  }
  MarchScene scene(std::span<const MarchSource> sources, int steps) const {
    return {.grid = grid_,
            .sources = sources,
            .active = active_.data(),
            .termination_threshold = 0,
            .min_steps = steps,
            .max_steps = steps};
  }

 private:
  float part() { return static_cast<float>(random_() % 1000) / 1000; }
  float slope() { return 2 * part() - 1; }
  /// A ray through a point of the middle plane along `axis`, given as shares of the size.
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
  std::vector<float> greys_, fours_, optics_;
  std::vector<std::uint32_t> active_;
};

}  // namespace splatlas
