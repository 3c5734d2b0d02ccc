#include "tests/format/derive/plain_smoothing.h"

#include <algorithm>
#include <cstdlib>

namespace splatlas::plain {
namespace {

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

Index3 moved(Index3 at, std::size_t axis, std::int64_t by) {
  at[axis] += by;
  return at;
}

Edge edge(const Index3& first, std::size_t axis) {
  return {first[0], first[1], first[2], static_cast<std::int64_t>(axis)};
}

Link link_of(const Mask& mask, const Index3& p, std::size_t a, std::size_t l, std::int64_t d) {
  const Index3 next = moved(p, a, 1), beside = moved(p, l, d), beside_next = moved(next, l, d);
  const Index3 o = d > 0 ? p : beside;
  const bool in_p = mask.holds(p), in_next = mask.holds(next);
  const bool in_beside = mask.holds(beside), in_both = mask.holds(beside_next);
  if (in_beside == in_p && in_both == in_next) return {Kind::kParallel, l, d, edge(beside, a)};
  if (in_beside == in_next && in_both == in_next) return {Kind::kLow, l, d, edge(o, l)};
  if (in_beside == in_p && in_both == in_p) return {Kind::kHigh, l, d, edge(moved(o, a, 1), l)};
  return {Kind::kCentre, l, d, edge(p, a)};
}

Net net_of(const Mask& mask) {
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

void find_directions(Net& net) {
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

void find_weights(Net& net) {
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

void relax(Net& net) {
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

}  // namespace

std::map<Edge, SmoothVertex> smooth_vertices(const Mask& mask) {
  Net net = net_of(mask);
  find_directions(net);
  find_weights(net);
  relax(net);
  std::map<Edge, SmoothVertex> result;
  for (const auto& [at, vertex] : net)
    result[at] = {128 + (vertex.now + (vertex.now < 0 ? -8 : 8)) / 16, vertex.direction};
  return result;
}

}  // namespace splatlas::plain
