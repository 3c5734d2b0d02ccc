#include "format/derive/coarse_surface.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/derive/masks.h"
#include "tests/format/random_volume.h"
#include "tests/support/closed_mesh.h"

namespace splatlas {
namespace {

Coverage coverage_of(const Mask& mask, int level) {
  Coverage coverage({{0, 0, 0}, {mask.size[0] - 1, mask.size[1] - 1, mask.size[2] - 1}}, level);
  const std::vector<ClassId> classes(mask.held.begin(), mask.held.end());
  coverage.add(encode_runs(classes, mask.size, Axis::kZ, 2).classes[1], mask.size[1]);
  return coverage;
}

Grid grid_of(const Mask& mask) {
  Grid grid;
  grid.size = mask.size;
  return grid;
}

/// A ball of `radius` voxels around a point, in a grid of 70 voxels along each axis.
Mask ball(const Vec3& centre, double radius) {
  return mask_of({70, 70, 70}, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const Vec3 from{static_cast<double>(i) - centre[0], static_cast<double>(j) - centre[1],
                    static_cast<double>(k) - centre[2]};
    return dot(from, from) <= radius * radius;
  });
}

Vec3 corner(const SurfaceMesh& mesh, std::uint32_t vertex) {
  const std::array<float, 3>& p = mesh.positions_ijk[vertex];
  return {p[0], p[1], p[2]};
}

/// Volume and centroid inside a mesh, in voxels.
struct Body {
  double volume = 0;
  Vec3 centroid{};
};

Body body_of(const SurfaceMesh& mesh) {
  Body body;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = corner(mesh, a), q = corner(mesh, b), r = corner(mesh, c);
    const double sixfold = dot(p, cross(q, r));
    body.volume += sixfold / 6;
    for (std::size_t axis = 0; axis < 3; ++axis)
      body.centroid[axis] += sixfold / 24 * (p[axis] + q[axis] + r[axis]);
  }
  for (double& c : body.centroid) c /= body.volume;
  return body;
}

RC_GTEST_PROP(Coverage, CountsTheVoxelsOfEachBlock, ()) {
  auto random = *random_source();
  Mask mask;
  for (std::int64_t& n : mask.size) n = 1 + static_cast<std::int64_t>(below(40, random));
  for (const ClassId c : random_classes(mask.size, 2, random)) mask.held.push_back(c != 0 ? 1 : 0);
  const int level = 1 + static_cast<int>(below(5, random));
  const Coverage coverage = coverage_of(mask, level);
  std::vector<int> counts(coverage.shares().size());
  for (std::int64_t n = 0; n < std::ssize(mask.held); ++n) {
    Index3 block{n % mask.size[0], n / mask.size[0] % mask.size[1], n / (mask.size[0] * mask.size[1])};
    for (std::size_t a = 0; a < 3; ++a) block[a] = (block[a] >> level) - coverage.first()[a];
    counts[static_cast<std::size_t>((block[2] * coverage.size()[1] + block[1]) * coverage.size()[0] +
                                    block[0])] += mask.held[static_cast<std::size_t>(n)];
  }
  for (std::size_t n = 0; n < counts.size(); ++n)
    RC_ASSERT(coverage.shares()[n] == counts[n] * (Coverage::kFull >> (3 * level)));
}

RC_GTEST_PROP(CoarseSurface, IsClosed, ()) {
  auto random = *random_source();
  Mask mask;
  for (std::int64_t& n : mask.size) n = 1 + static_cast<std::int64_t>(below(20, random));
  for (const ClassId c : random_classes(mask.size, 2, random)) mask.held.push_back(c != 0 ? 1 : 0);
  const auto mesh = coarse_surface(coverage_of(mask, 1 + static_cast<int>(below(2, random))), grid_of(mask));
  if (!mesh) return;
  RC_ASSERT(is_closed(mesh->triangles));
  for (const std::array<float, 3>& normal : mesh->normals_lps)
    RC_ASSERT(std::abs(dot(normal, normal) - 1) < 1e-5f);
}

/// A shift of half a voxel is the likely error.
TEST(CoarseSurface, KeepsPlaceSizeAndNormalsOfABall) {
  const Vec3 centre{34.3, 33.8, 35.1};
  const Mask mask = ball(centre, 24);
  const double voxels = static_cast<double>(std::ranges::count(mask.held, 1));
  for (const int level : {1, 2, 3}) {
    SCOPED_TRACE(level);
    const auto mesh = coarse_surface(coverage_of(mask, level), grid_of(mask));
    ASSERT_TRUE(mesh);
    const Body body = body_of(*mesh);
    EXPECT_NEAR(body.volume / voxels, 1, 0.01);
    double distance = 0;
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(body.centroid[a], centre[a], 0.02 * std::ldexp(1.0, level));
    for (std::uint32_t v = 0; v < mesh->positions_ijk.size(); ++v) {
      const Vec3 at = corner(*mesh, v), from = difference(at, centre);
      const double radius = std::sqrt(dot(from, from));
      const std::array<float, 3>& n = mesh->normals_lps[v];
      distance += std::abs(radius - 24) / static_cast<double>(mesh->positions_ijk.size());
      ASSERT_LT(std::abs(radius - 24), 0.4 * std::ldexp(1.0, level));
      ASSERT_GT(dot(from, {n[0], n[1], n[2]}) / radius, 0.97);
    }
    EXPECT_LT(distance, 0.2 * level);
  }
}

/// Mirrored and anisotropic grids: normals are in LPS, and fronts counter-clockwise there.
TEST(CoarseSurface, TurnsOutwardsInMirroredGrids) {
  const Mask mask = ball({35, 35, 35}, 20);
  Grid grid = grid_of(mask);
  grid.spacing_mm = {1, 1, 3};
  grid.direction_lps = {0, -1, 0, -1, 0, 0, 0, 0, 1};
  const Grid mirrored = [&] {
    Grid other = grid;
    other.direction_lps[8] = -1;
    return other;
  }();
  for (const Grid& of : {grid, mirrored}) {
    const auto mesh = coarse_surface(coverage_of(mask, 1), of);
    ASSERT_TRUE(mesh);
    const Affine to_lps = index_to_lps_mm(of);
    for (const auto& [a, b, c] : mesh->triangles) {
      const Vec3 p = to_lps.apply(corner(*mesh, a)), q = to_lps.apply(corner(*mesh, b)),
                 r = to_lps.apply(corner(*mesh, c));
      const Vec3 front = cross(difference(q, p), difference(r, p));
      const std::array<float, 3>& n = mesh->normals_lps[a];
      ASSERT_GT(dot(front, {n[0], n[1], n[2]}), 0);
    }
  }
}

/// Vessels of two voxels and sheets of one remain, wherever they run through the blocks.
TEST(CoarseSurface, KeepsThinPartsOrRefuses) {
  for (std::int64_t shift = 0; shift < 4; ++shift) {
    const Mask vessel = mask_of({60, 60, 60}, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      return std::abs(i - 20 - shift - k / 4) < 2 - (i < 20 + shift + k / 4) && (j - 20 - shift) / 2 == 0 &&
             j >= 20 + shift;
    });
    const Mask sheet = mask_of({60, 60, 60}, [&](auto, auto, std::int64_t k) { return k == 20 + shift; });
    for (const Mask* mask : {&vessel, &sheet}) {
      const auto mesh = coarse_surface(coverage_of(*mask, 1), grid_of(*mask));
      ASSERT_TRUE(mesh);
      for (std::int64_t k = 0; k < 60; ++k) {
        for (std::int64_t j = 0; j < 60; ++j) {
          for (std::int64_t i = 0; i < 60; ++i) {
            if (!mask->holds({i, j, k})) continue;
            const bool is_near = std::ranges::any_of(mesh->positions_ijk, [&](const std::array<float, 3>& p) {
              return std::abs(p[0] - static_cast<float>(i)) <= 2 &&
                     std::abs(p[1] - static_cast<float>(j)) <= 2 &&
                     std::abs(p[2] - static_cast<float>(k)) <= 2;
            });
            ASSERT_TRUE(is_near) << i << " " << j << " " << k;
          }
        }
      }
    }
    EXPECT_FALSE(coarse_surface(coverage_of(vessel, 3), grid_of(vessel)));
  }
}

/// The blocks of one structure are those that the other leaves.
TEST(CoarseSurface, LeavesNoGapBetweenStructures) {
  const auto in_ball = [](std::int64_t i, std::int64_t j, std::int64_t k) {
    return (i - 35) * (i - 35) + (j - 35) * (j - 35) + (k - 35) * (k - 35) <= 900;
  };
  const Mask left =
      mask_of({70, 70, 70}, [&](auto i, auto j, auto k) { return in_ball(i, j, k) && i + j / 3 < 45; });
  const Mask right =
      mask_of({70, 70, 70}, [&](auto i, auto j, auto k) { return in_ball(i, j, k) && i + j / 3 >= 45; });
  for (const int level : {1, 2}) {
    double volume = 0;
    for (const Mask* mask : {&left, &right}) {
      const auto mesh = coarse_surface(coverage_of(*mask, level), grid_of(*mask));
      ASSERT_TRUE(mesh);
      volume += body_of(*mesh).volume;
    }
    const auto whole = coarse_surface(coverage_of(ball({35, 35, 35}, 30), level), grid_of(left));
    EXPECT_NEAR(volume / body_of(*whole).volume, 1, 0.01);
  }
}

}  // namespace
}  // namespace splatlas
