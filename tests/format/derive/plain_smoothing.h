// Slow smoothing of surfaces, written from docs/atlas_surfaces.md alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "format/content/grid.h"
#include "format/content/unit_vector.h"
#include "tests/format/derive/masks.h"
#include "tests/format/random_volume.h"

namespace splatlas::plain {
/// A crossed edge: its first voxel, and its axis.
using Edge = std::array<std::int64_t, 4>;

struct SmoothVertex {
  std::int64_t offset = 0;  ///< from the first voxel, in 1/256 voxel
  std::array<std::int64_t, 3> direction{0, 0, 0};
  friend bool operator==(const SmoothVertex&, const SmoothVertex&) = default;
};

using Vector = std::array<std::int64_t, 3>;

enum class Kind { kParallel, kLow, kHigh, kCentre };

struct Link {
  Kind kind = Kind::kCentre;
  std::size_t axis = 0;
  std::int64_t sign = 0;
  Edge neighbour{};
};

struct Vertex {
  std::int64_t sign = 0;  // 1 if the first voxel is inside
  std::array<Link, 4> links{};
  Vector sum{0, 0, 0}, direction{0, 0, 0};
  std::int64_t constant = 0, before = 0, now = 0;
  std::array<std::int64_t, 4> weights{};
};
using Net = std::map<Edge, Vertex>;

inline Index3 moved(Index3 at, std::size_t axis, std::int64_t by) {
  at[axis] += by;
  return at;
}

inline Edge edge(const Index3& first, std::size_t axis) {
  return {first[0], first[1], first[2], static_cast<std::int64_t>(axis)};
}

inline Link link_of(const Mask& mask, const Index3& p, std::size_t a, std::size_t l, std::int64_t d) {
  const Index3 next = moved(p, a, 1), beside = moved(p, l, d), beside_next = moved(next, l, d);
  const Index3 o = d > 0 ? p : beside;
  const bool in_p = mask.holds(p), in_next = mask.holds(next);
  const bool in_beside = mask.holds(beside), in_both = mask.holds(beside_next);
  if (in_beside == in_p && in_both == in_next) return {Kind::kParallel, l, d, edge(beside, a)};
  if (in_beside == in_next && in_both == in_next) return {Kind::kLow, l, d, edge(o, l)};
  if (in_beside == in_p && in_both == in_p) return {Kind::kHigh, l, d, edge(moved(o, a, 1), l)};
  return {Kind::kCentre, l, d, edge(p, a)};
}

inline Net net_of(const Mask& mask) {
  Net net;
  for (std::int64_t k = -1; k < mask.size[2]; ++k) {
    for (std::int64_t j = -1; j < mask.size[1]; ++j) {
      for (std::int64_t i = -1; i < mask.size[0]; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
          const Index3 p{i, j, k};
          if (mask.holds(p) == mask.holds(moved(p, a, 1))) continue;
          Vertex vertex;
          vertex.sign = mask.holds(p) ? 1 : -1;
          const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
          vertex.links = {link_of(mask, p, a, b, 1), link_of(mask, p, a, b, -1), link_of(mask, p, a, c, 1),
                          link_of(mask, p, a, c, -1)};
          vertex.sum[a] = vertex.sign << 20;
          vertex.direction = vertex.sum;
          net.emplace(edge(p, a), vertex);
        }
      }
    }
  }
  return net;
}

inline void find_directions(Net& net) {
  for (int step = 1; step <= 16; ++step) {
    const Net old = net;
    for (auto& [at, vertex] : net) {
      for (std::size_t n = 0; n < 3; ++n) {
        for (const Link& link : vertex.links) vertex.sum[n] += old.at(link.neighbour).sum[n];
        if (step % 4 == 0) vertex.sum[n] /= 625;
      }
      const std::int64_t length = std::abs(vertex.sum[0]) + std::abs(vertex.sum[1]) + std::abs(vertex.sum[2]);
      if (step % 4 == 0 && length >= 5 * 65536) vertex.direction = vertex.sum;
    }
  }
}

inline void find_weights(Net& net) {
  for (auto& [at, vertex] : net) {
    const auto a = static_cast<std::size_t>(at[3]);
    std::array<std::int64_t, 4> alpha{}, beta{};
    std::int64_t largest = 0;
    for (std::size_t q = 0; q < 4; ++q) {
      const Link& link = vertex.links[q];
      const Vector& other = net.at(link.neighbour).direction;
      alpha[q] = vertex.sign * (vertex.direction[a] + other[a]);
      beta[q] = vertex.sign * link.sign * (vertex.direction[link.axis] + other[link.axis]);
      largest = std::max({largest, std::abs(alpha[q]), std::abs(beta[q])});
    }
    std::int64_t den = 0, con = 0;
    std::array<std::int64_t, 4> w{};
    for (std::size_t q = 0; q < 4; ++q) {
      std::int64_t down = 1, up = 1;
      for (std::int64_t size = largest; size >= 1 << 14; size /= 2) down *= 2;
      for (std::int64_t size = largest; size > 0 && size < 1 << 13; size *= 2) up *= 2;
      alpha[q] = alpha[q] / down * up;
      beta[q] = beta[q] / down * up;
      den += alpha[q];
      switch (vertex.links[q].kind) {
        case Kind::kParallel:
          con += 2 * beta[q];
          w[q] = alpha[q];
          break;
        case Kind::kLow:
          con += beta[q] - alpha[q];
          w[q] = vertex.links[q].sign * beta[q];
          break;
        case Kind::kHigh:
          con += beta[q] + alpha[q];
          w[q] = vertex.links[q].sign * beta[q];
          break;
        case Kind::kCentre: con += beta[q]; break;
      }
    }
    if (den <= 0) continue;
    const std::int64_t inverse = (std::int64_t{1} << 29) / (den + 1024);
    for (std::size_t q = 0; q < 4; ++q) vertex.weights[q] = w[q] * inverse / (1 << 18);
    vertex.constant = con * inverse / (1 << 7);
  }
}

inline void relax(Net& net) {
  constexpr std::array<std::int64_t, 7> kOmega{4096, 7464, 6956, 6640, 6458, 6358, 6304};
  for (std::size_t step = 0; step < 8; ++step) {
    const Net old = net;
    for (auto& [at, vertex] : net) {
      std::int64_t target = vertex.constant;
      for (std::size_t q = 0; q < 4; ++q) target += vertex.weights[q] * old.at(vertex.links[q].neighbour).now;
      target = std::clamp<std::int64_t>(target / 2048, -8192, 8192);
      const std::int64_t now = vertex.now;
      const std::int64_t next = step < 7 ? vertex.before + kOmega[step] * (target - vertex.before) / 4096
                                         : now + 2731 * (target - now) / 4096;
      vertex.before = now;
      vertex.now = std::clamp<std::int64_t>(next, -1792, 1792);
    }
  }
}

inline std::map<Edge, SmoothVertex> smooth_vertices(const Mask& mask) {
  Net net = net_of(mask);
  find_directions(net);
  find_weights(net);
  relax(net);
  std::map<Edge, SmoothVertex> result;
  for (const auto& [at, vertex] : net)
    result[at] = {128 + (vertex.now + (vertex.now < 0 ? -8 : 8)) / 16, vertex.direction};
  return result;
}

using Position = std::array<float, 3>;

/// Positions of smoothing 2.
inline std::map<Edge, Position> across_vertices(const Mask& mask, const Vec3& spacing) {
  struct Moving {
    Position n{}, x{}, d{};
    std::array<float, 4> f{}, g{}, e{};
    std::array<Position, 4> u{}, y{};
    float reach = 0;
  };
  Position r{};
  for (std::size_t a = 0; a < 3; ++a) r[a] = static_cast<float>(spacing[a] / std::ranges::max(spacing));
  std::map<Edge, Moving> all;
  for (const auto& [at, smooth] : smooth_vertices(mask)) {
    Moving& of = all[at];
    for (std::size_t a = 0; a < 3; ++a) {
      of.n[a] = static_cast<float>(smooth.direction[a]) / r[a];
      of.x[a] = static_cast<float>(at[a]) + (at[3] == static_cast<std::int64_t>(a) ? 0.5f : 0);
    }
    const float length = std::sqrt(dot(of.n, of.n));
    for (float& n : of.n) n /= length;
  }
  const Net net = net_of(mask);
  for (auto& [at, of] : all) {
    for (std::size_t q = 0; q < 4; ++q) {
      const Edge& neighbour = net.at(at).links[q].neighbour;
      const Moving& other = all.at(neighbour);
      const Position m{of.n[0] + other.n[0], of.n[1] + other.n[1], of.n[2] + other.n[2]};
      const float l = std::sqrt(dot(m, m));
      of.f[q] = neighbour == at ? 0 : std::min(std::max(5 * l - 8, 0.0f), 1.0f);
      if (of.f[q] <= 0) continue;
      of.u[q] = {m[0] / l, m[1] / l, m[2] / l};
      for (std::size_t a = 0; a < 3; ++a) of.y[q][a] = r[a] * (other.x[a] - of.x[a]);
    }
    const float sum = (of.f[0] + of.f[1]) + (of.f[2] + of.f[3]);
    of.reach = sum / 8;
    for (std::size_t q = 0; q < 4 && sum > 0; ++q) of.g[q] = 0.875f * of.f[q] / sum;
    for (std::size_t q = 0; q < 4 && sum > 0; ++q) of.e[q] = 0.1875f * std::min(of.f[q], of.f[q ^ 1]) / sum;
  }
  for (int step = 0; step < 14; ++step) {
    const std::map<Edge, Moving> old = all;
    for (auto& [at, of] : all) {
      std::array<Position, 4> y{}, z{};
      Position b{};
      for (std::size_t q = 0; q < 4; ++q) {
        const Position& d = old.at(net.at(at).links[q].neighbour).d;
        for (std::size_t a = 0; a < 3; ++a) y[q][a] = of.y[q][a] + (d[a] - of.d[a]);
        for (std::size_t a = 0; a < 3; ++a) z[q][a] = (of.g[q] * dot(of.u[q], y[q])) * of.u[q][a];
      }
      for (std::size_t a = 0; a < 3; ++a)
        b[a] = of.e[0] * (y[0][a] + y[1][a]) + of.e[2] * (y[2][a] + y[3][a]);
      const float up = dot(of.n, b);
      for (std::size_t a = 0; a < 3; ++a)
        of.d[a] += ((z[0][a] + z[1][a]) + (z[2][a] + z[3][a])) + (b[a] - up * of.n[a]);
      const float squared = dot(of.d, of.d), limit = of.reach * of.reach;
      for (float& d : of.d) d *= squared <= limit ? 1 : of.reach / std::sqrt(squared);
    }
  }
  std::map<Edge, Position> positions;
  for (const auto& [at, of] : all) {
    for (std::size_t a = 0; a < 3; ++a) {
      positions[at][a] = std::clamp(of.x[a] + std::round(128 * (of.d[a] / r[a])) / 128, -1.0f,
                                    static_cast<float>(mask.size[a]));
    }
  }
  return positions;
}

/// Noise of any density, or a ball with bumps.
inline Mask random_mask(std::mt19937& random) {
  Index3 size{};
  for (std::int64_t& n : size) n = 1 + static_cast<std::int64_t>(below(9, random));
  const std::size_t density = 2 + below(69, random);  // per cent
  if (below(3, random) != 0) {
    return mask_of(size, [&](auto, auto, auto) { return below(100, random) < density; });
  }
  return mask_of(size, [&](auto i, auto j, auto k) {
    const std::int64_t x = 2 * i - size[0] + 1, y = 2 * j - size[1] + 1, z = 2 * k - size[2] + 1;
    return x * x + y * y + z * z < 30 + static_cast<std::int64_t>(below(30, random));
  });
}

}  // namespace splatlas::plain
