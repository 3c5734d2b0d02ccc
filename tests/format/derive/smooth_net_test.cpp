#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/derive/surface_net.h"
#include "tests/format/derive/masks.h"
#include "tests/format/random_volume.h"
#include "tests/phantom/two_spheres.h"

/// Slow smoothing of surfaces, written from docs/atlas_surfaces.md alone.
namespace splatlas::plain {
/// A crossed edge: its first voxel, and its axis.
using Edge = std::array<std::int64_t, 4>;

struct SmoothVertex {
  std::int64_t offset = 0;  ///< from the first voxel, in 1/256 voxel
  std::array<std::int64_t, 3> direction{0, 0, 0};
  friend bool operator==(const SmoothVertex&, const SmoothVertex&) = default;
};

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

namespace splatlas {
namespace {

using plain::Edge;
using plain::SmoothVertex;
using Vertices = std::map<Edge, SmoothVertex>;

Vertices smoothed(const Mask& mask) {
  const SurfaceNet net = surface_net(crop_of(mask));
  const SmoothedNet result = smooth(net);
  Vertices vertices;
  for (std::size_t v = 0; v < net.vertices.size(); ++v) {
    const std::array<std::int32_t, 3>& voxel = net.vertices[v].voxel;
    const auto axis = static_cast<std::int64_t>(net.vertices[v].axis());
    const auto& d = result.directions[v];
    vertices[{voxel[0], voxel[1], voxel[2], axis}] = {result.offsets[v], {d[0], d[1], d[2]}};
  }
  return vertices;
}

/// Noise of any density, or a ball with bumps.
Mask random_mask(std::mt19937& random) {
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

RC_GTEST_PROP(Smooth, EqualsThePlainDefinition, ()) {
  auto random = *random_source();
  const Mask mask = random_mask(random);
  const Vertices expected = plain::smooth_vertices(mask);
  RC_ASSERT(smoothed(mask) == expected);
}

/// FNV-1a of 64 bits over offsets in the order of vertices.
std::uint64_t hash_of(const Mask& mask) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint8_t offset : smooth(surface_net(crop_of(mask))).offsets)
    hash = (hash ^ offset) * 0x100000001b3;
  return hash;
}

TEST(Smooth, TheBallsOfThePhantomHaveTheseBits) {
  std::vector<std::uint64_t> hashes;
  for (const phantom::Ball& ball : phantom::kBalls) {
    const Mask mask = mask_of({phantom::kSize, phantom::kSize, phantom::kSize}, [&](auto i, auto j, auto k) {
      return ball.holds(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    });
    hashes.push_back(hash_of(mask));
  }
  EXPECT_EQ(hashes, (std::vector<std::uint64_t>{14514533835157610623u, 2287289982503310639u}));
}

/// Errors against a shape of a closed form: angles of directions in degrees, distances of vertices in mm.
struct Errors {
  double normals_rms = 0, normals_max = 0, distance_rms = 0, distance_max = 0, moved_max = 0;
};

/// `distance(p)` and `normal(p)` of the shape at a position in mm; vertices count if `counts(p)`.
template <typename Distance, typename Normal, typename Counts>
Errors errors_of(const Mask& mask, const Vec3& spacing, const Distance& distance, const Normal& normal,
                 const Counts& counts) {
  Errors errors;
  double n = 0;
  for (const auto& [edge, vertex] : smoothed(mask)) {
    Vec3 p{}, direction{};
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = static_cast<double>(edge[a]) +
             (edge[3] == static_cast<std::int64_t>(a) ? static_cast<double>(vertex.offset) / 256 : 0);
      p[a] *= spacing[a];
      direction[a] = static_cast<double>(vertex.direction[a]) / spacing[a];  // a covector
    }
    if (!counts(p)) continue;
    const Vec3 truth = normal(p);
    const double cosine = dot(direction, truth) / std::sqrt(dot(direction, direction) * dot(truth, truth));
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI, away = std::abs(distance(p));
    errors.normals_rms += angle * angle;
    errors.normals_max = std::max(errors.normals_max, angle);
    errors.distance_rms += away * away;
    errors.distance_max = std::max(errors.distance_max, away);
    errors.moved_max = std::max(errors.moved_max, std::abs(static_cast<double>(vertex.offset) / 256 - 0.5));
    ++n;
  }
  errors.normals_rms = std::sqrt(errors.normals_rms / n);
  errors.distance_rms = std::sqrt(errors.distance_rms / n);
  return errors;
}

/// A ball off the voxel centres.
Errors ball_errors(double radius, const Vec3& spacing, const Vec3& offset) {
  Index3 size{};
  Vec3 center{};
  for (std::size_t a = 0; a < 3; ++a) {
    size[a] = 2 * static_cast<std::int64_t>(std::ceil(radius / spacing[a])) + 5;
    center[a] = (static_cast<double>(size[a] - 1) / 2 + offset[a]) * spacing[a];
  }
  const auto from_center = [&](const Vec3& p) {
    return Vec3{p[0] - center[0], p[1] - center[1], p[2] - center[2]};
  };
  const auto distance = [&](const Vec3& p) {
    const Vec3 d = from_center(p);
    return std::hypot(d[0], d[1], d[2]) - radius;
  };
  const Mask mask = mask_of(size, [&](auto i, auto j, auto k) {
    return distance({static_cast<double>(i) * spacing[0], static_cast<double>(j) * spacing[1],
                     static_cast<double>(k) * spacing[2]}) < 0;
  });
  return errors_of(mask, spacing, distance, from_center, [](const Vec3&) { return true; });
}

TEST(Smooth, BallsAreRound) {
  struct Bound {
    double radius, normals_rms, normals_max, distance_rms, distance_max;
  };
  for (const Bound& bound : {Bound{6, 3.55, 8.5, .0685, .245}, Bound{10, 2.15, 5.5, .0455, .265},
                             Bound{20, 1.25, 4.5, .0415, .175}, Bound{40, 1.05, 5.5, .0425, .295}}) {
    const Errors errors = ball_errors(bound.radius, {1, 1, 1}, {.15, .35, .4});
    EXPECT_LT(errors.normals_rms, bound.normals_rms) << bound.radius;
    EXPECT_LT(errors.normals_max, bound.normals_max) << bound.radius;
    EXPECT_LT(errors.distance_rms, bound.distance_rms) << bound.radius;
    EXPECT_LT(errors.distance_max, bound.distance_max) << bound.radius;
    EXPECT_LT(errors.moved_max, 0.5) << bound.radius;
  }
}

/// Between two parallel planes across a unit direction, `thickness` apart; vertices near the border of the
/// grid do not count.
Errors plate_errors(Vec3 across, double thickness, const Vec3& middle = {39.6, 39.3, 39.45}) {
  const double length = std::hypot(across[0], across[1], across[2]);
  for (double& x : across) x /= length;
  constexpr std::int64_t kSize = 80, kBorder = 18;
  const auto height = [&](const Vec3& p) {
    return (p[0] - middle[0]) * across[0] + (p[1] - middle[1]) * across[1] + (p[2] - middle[2]) * across[2];
  };
  const Mask mask = mask_of({kSize, kSize, kSize}, [&](auto i, auto j, auto k) {
    return std::abs(height({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})) <
           thickness / 2;
  });
  return errors_of(
      mask, {1, 1, 1}, [&](const Vec3& p) { return std::abs(height(p)) - thickness / 2; },
      [&](const Vec3& p) {
        const double side = height(p) < 0 ? -1 : 1;
        return Vec3{side * across[0], side * across[1], side * across[2]};
      },
      [&](const Vec3& p) {
        return std::ranges::all_of(p, [](double x) { return x > kBorder && x < kSize - 1 - kBorder; });
      });
}

TEST(Smooth, PlatesAreFlat) {
  const Errors tilted = plate_errors({1, .3, .15}, 20);
  EXPECT_LT(tilted.normals_rms, .65);
  EXPECT_LT(tilted.normals_max, 1);
  const Errors terraces = plate_errors({.1, .05, 1}, 20);
  EXPECT_LT(terraces.normals_rms, 3.05);
  EXPECT_LT(terraces.normals_max, 5.1);
  EXPECT_LT(terraces.distance_rms, .078);
  const Errors sheet = plate_errors({1, .3, .15}, 1.1, {40.1, 40.2, 40.3});
  EXPECT_LT(sheet.normals_rms, .75);
  EXPECT_LT(sheet.normals_max, 1.5);
}

Errors vessel_errors(Vec3 along, double radius, const Vec3& middle) {
  const double length = std::hypot(along[0], along[1], along[2]);
  for (double& x : along) x /= length;
  constexpr std::int64_t kSize = 70, kBorder = 17;
  const auto from_axis = [&](const Vec3& p) {
    const Vec3 d{p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]};
    const double t = dot(d, along);
    return Vec3{d[0] - t * along[0], d[1] - t * along[1], d[2] - t * along[2]};
  };
  const auto distance = [&](const Vec3& p) {
    const Vec3 d = from_axis(p);
    return std::hypot(d[0], d[1], d[2]) - radius;
  };
  const Mask mask = mask_of({kSize, kSize, kSize}, [&](auto i, auto j, auto k) {
    return distance({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) < 0;
  });
  return errors_of(mask, {1, 1, 1}, distance, from_axis, [&](const Vec3& p) {
    const double t =
        (p[0] - middle[0]) * along[0] + (p[1] - middle[1]) * along[1] + (p[2] - middle[2]) * along[2];
    return std::abs(t) < kSize / 2 - kBorder;
  });
}

TEST(Smooth, VesselsKeepTheirRadius) {
  const Errors straight = vessel_errors({0, 0, 1}, 1.5, {35.1, 35.3, 35});
  EXPECT_LT(straight.normals_rms, 12.1);
  EXPECT_LT(straight.distance_rms, .165);
  const Errors tilted = vessel_errors({1, .7, .4}, 1.5, {35.15, 35.35, 35.4});
  EXPECT_LT(tilted.normals_rms, 6.3);
  EXPECT_LT(tilted.distance_rms, .07);
  EXPECT_LT(tilted.distance_max, .17);
}

TEST(Smooth, SingleVoxelsAndLinesStayAsTheyAre) {
  for (const Index3 size : {Index3{1, 1, 1}, Index3{2, 1, 1}}) {
    for (const auto& [edge, vertex] : smoothed(mask_of(size, [](auto, auto, auto) { return true; }))) {
      EXPECT_EQ(vertex.offset, 128);
      const auto axis = static_cast<std::size_t>(edge[3]);
      const bool is_low_side = edge[axis] < 0;
      EXPECT_EQ(vertex.direction[axis] < 0, is_low_side);
      EXPECT_NE(vertex.direction[axis], 0);
    }
  }
}

}  // namespace
}  // namespace splatlas
