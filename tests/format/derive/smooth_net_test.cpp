#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/derive/fit_surface.h"
#include "tests/format/derive/plain_smoothing.h"
#include "tests/format/random_volume.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/closed_mesh.h"

namespace splatlas {
namespace {

using plain::Edge;
using plain::random_mask;
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

RC_GTEST_PROP(Smooth, EqualsThePlainDefinition, ()) {
  auto random = *random_source();
  const Mask mask = random_mask(random);
  const Vertices expected = plain::smooth_vertices(mask);
  RC_ASSERT(smoothed(mask) == expected);
}

/// FNV-1a hashes of 64 bits over the bytes of each ball of the phantom, `bytes_of(mask)`.
template <typename BytesOf>
std::vector<std::uint64_t> hashes_of_balls(const BytesOf& bytes_of) {
  std::vector<std::uint64_t> hashes;
  for (const phantom::Ball& ball : phantom::kBalls) {
    const Mask mask = mask_of({phantom::kSize, phantom::kSize, phantom::kSize}, [&](auto i, auto j, auto k) {
      return ball.holds(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    });
    std::uint64_t& hash = hashes.emplace_back(0xcbf29ce484222325);
    for (const std::uint8_t byte : bytes_of(mask)) hash = (hash ^ byte) * 0x100000001b3;
  }
  return hashes;
}

TEST(Smooth, TheBallsOfThePhantomHaveTheseBits) {
  EXPECT_EQ(hashes_of_balls([](const Mask& mask) { return smooth(surface_net(crop_of(mask))).offsets; }),
            (std::vector<std::uint64_t>{14514533835157610623u, 2287289982503310639u}));
}

TEST(SmoothAcross, TheBallsOfThePhantomHaveTheseBits) {
  const auto bytes_of = [](const Mask& mask) {
    const Grid grid{.size = mask.size, .spacing_mm = {1, 1, 3}};
    std::vector<std::uint8_t> bytes;
    for (const auto& position : fit_surface(crop_of(mask), grid, SurfaceRule::kUneven).positions_ijk) {
      for (const float x : position) {
        for (const int shift : {0, 8})
          bytes.push_back(static_cast<std::uint8_t>(std::lround(128 * (x + 1)) >> shift));
      }
    }
    return bytes;
  };
  EXPECT_EQ(hashes_of_balls(bytes_of),
            (std::vector<std::uint64_t>{16261308938062011683u, 2540901935489487139u}));
}

/// Errors against a shape of a closed form: angles of directions in degrees, distances of vertices in mm.
struct Errors {
  double normals_rms = 0, normals_max = 0, distance_rms = 0, distance_max = 0;
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
  }
}

/// Between two parallel planes across a unit direction, `thickness` apart; without vertices near the border.
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

std::map<Edge, plain::Position> moved_across(const Mask& mask, const Vec3& spacing) {
  const SurfaceNet net = surface_net(crop_of(mask));
  const auto positions = smooth_across(net, smooth(net), {.size = mask.size, .spacing_mm = spacing});
  std::map<Edge, plain::Position> vertices;
  for (std::size_t v = 0; v < net.vertices.size(); ++v) {
    const auto& [i, j, k] = net.vertices[v].voxel;
    vertices[{i, j, k, static_cast<std::int64_t>(net.vertices[v].axis())}] = positions[v];
  }
  return vertices;
}

RC_GTEST_PROP(SmoothAcross, EqualsThePlainDefinition, ()) {
  auto random = *random_source();
  const Mask mask = random_mask(random);
  Vec3 spacing{};
  for (double& side : spacing) side = std::array{0.3, 0.95, 1.0, 1.6, 4.1}[below(5, random)];
  RC_ASSERT(moved_across(mask, spacing) == plain::across_vertices(mask, spacing));
}

const Grid kGrid{.size = {60, 60, 15}, .spacing_mm = {1, 1, 4}};

Vec3 mm(const std::array<float, 3>& ijk) {
  return {double{ijk[0]} - 29.5, double{ijk[1]} - 29.5, 4 * (double{ijk[2]} - 7)};
}

/// Midway, and by smoothing 1 and 2: the surfaces of the voxels with holds(x, y, z) in mm from the middle.
template <typename Holds>
std::array<SurfaceMesh, 3> surfaces_of(const Holds& holds) {
  const StructureCrop crop = crop_of(mask_of(kGrid.size, [&](auto i, auto j, auto k) {
    const auto [x, y, z] = mm({static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)});
    return holds(x, y, z);
  }));
  return {fit_surface(crop, kGrid, SurfaceRule::kVoxels), fit_surface(crop, kGrid, SurfaceRule::kSmooth),
          fit_surface(crop, kGrid, SurfaceRule::kUneven)};
}

double enclosed_mm3(const SurfaceMesh& mesh) {
  return enclosed_volume(mesh.triangles, [&](std::uint32_t v) { return mm(mesh.positions_ijk[v]); });
}

/// Root mean square distance from a tube of 12 mm around z, up to 14 mm from the middle slice.
double rms_from_tube(const SurfaceMesh& mesh) {
  double sum = 0, count = 0;
  for (const auto& ijk : mesh.positions_ijk) {
    const auto [x, y, z] = mm(ijk);
    sum += std::abs(z) > 14 ? 0 : std::pow(std::hypot(x, y) - 12, 2);
    count += std::abs(z) > 14 ? 0 : 1;
  }
  return std::sqrt(sum / count);
}

/// Triangles that show their backs where their normals point: slits in pictures.
std::ptrdiff_t reversed_triangles(const SurfaceMesh& mesh) {
  return std::ranges::count_if(mesh.triangles, [&](const auto& t) {
    const auto &p = mesh.positions_ijk, &n = mesh.normals_lps;
    const auto front = cross(difference(p[t[1]], p[t[0]]), difference(p[t[2]], p[t[0]]));  // of index space
    return std::ranges::all_of(t, [&](std::uint32_t v) {
      return dot(front, {4 * n[v][0], 4 * n[v][1], n[v][2]}) < 0;
    });
  });
}

TEST(SmoothAcross, ContoursThatJumpFromSliceToSliceAreJoined) {
  const auto [before, smooth, after] = surfaces_of([&](double x, double y, double z) {
    return std::hypot(x - 1.5 * std::sin(2.3 * z / 4), y) < 12 && std::abs(z) < 22;
  });
  EXPECT_EQ(after.triangles, before.triangles);
  EXPECT_EQ(after.normals_lps, smooth.normals_lps);
  EXPECT_GT(rms_from_tube(before), 0.5);
  EXPECT_LT(rms_from_tube(after), 0.2);
  EXPECT_EQ(reversed_triangles(after), 0);
  double farthest = 0;
  for (std::size_t v = 0; v < after.positions_ijk.size(); ++v) {
    const Vec3 from = mm(before.positions_ijk[v]), to = mm(after.positions_ijk[v]);
    farthest = std::max(farthest, std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
  }
  EXPECT_GT(farthest, 1);
  EXPECT_LT(farthest, 2 + 4.0 / 128);  // half a slice, rounded
}

TEST(SmoothAcross, BallsVesselsAndSheetsKeepTheirSize) {
  const auto change = [](const auto& holds) {
    const auto [before, smooth, after] = surfaces_of(holds);
    return std::abs(enclosed_mm3(after) / enclosed_mm3(before) - 1);
  };
  EXPECT_LT(change([](double x, double y, double z) { return x * x + y * y + z * z < 400; }), 0.01);
  const auto in_sheet = [](double slope) {
    return [slope](double x, double y, double z) {
      return std::abs(x - slope * z) <= 0.5 && std::abs(z) < 22 && std::abs(y) < 20;
    };
  };
  for (const double slope : {0.0, 0.25}) {
    const auto in_vessel = [&](double x, double y, double z) {
      return std::hypot(x - slope * z, y) < 1.6 && std::abs(z) < 22;
    };
    EXPECT_LT(change(in_vessel), 0.1) << slope;
    EXPECT_LT(change(in_sheet(slope)), 0.08) << slope;
    const auto across = [&](double x, double y, double z) {
      return std::abs(z + slope * x) <= 2 && std::hypot(x, y) < 22;
    };
    EXPECT_LT(change(across), 0.03) << slope;
  }
  EXPECT_LT(change(in_sheet(0.5)), 0.21);  // pieces of two voxels' distance, which touch nowhere
}

/// Two structures that fill the grid. Vertices reach 30 links far: 16 steps of directions, 14 of smoothing 2.
TEST(SmoothAcross, StructuresThatTouchShareTheirBorder) {
  const auto half = [](bool side) {
    const auto holds = [&](auto, auto j, auto k) {
      return (static_cast<double>(j) > 6 + 2.2 * std::sin(2.3 * static_cast<double>(k))) == side;
    };
    return moved_across(mask_of({96, 12, 96}, holds), {1, 1, 4});
  };
  const auto first = half(true), second = half(false);
  double shared = 0, apart = 0;  // apart: beside the background
  for (const auto& [edge, position] : first) {
    if (!second.contains(edge)) continue;
    const plain::Position way = difference(position, second.at(edge));
    EXPECT_TRUE(dot(way, way) == 0 || std::min(edge[0], edge[2]) <= 30 || std::max(edge[0], edge[2]) >= 64);
    apart += way[0] * way[0] + way[1] * way[1] + 16 * way[2] * way[2];
    ++shared;
  }
  EXPECT_GT(shared, 9000);
  EXPECT_LT(std::sqrt(apart / shared), 0.32);
}

}  // namespace
}  // namespace splatlas
