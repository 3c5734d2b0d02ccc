#include "preprocess/surfaces/clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/preprocess/random_images.h"

namespace splatlas {
namespace {

TriangleMesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleMesh mesh;
  mesh.positions_lps_mm = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Vec3 corner_of(const SurfaceMesh& mesh, std::uint32_t v) {
  const auto& [i, j, k] = mesh.positions_ijk[v];
  return {i, j, k};
}

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 twice = cross(difference(b, a), difference(c, a));
  return {0.5 * twice[0], 0.5 * twice[1], 0.5 * twice[2]};
}

/// Area, and for a closed surface the enclosed volume, in voxels.
struct Extent {
  double area = 0, volume = 0;

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 v = area_vector(a, b, c);
    area += std::hypot(v[0], v[1], v[2]);
    volume += dot(a, v) / 3;
  }
};

Extent extent_of(const SurfaceMesh& mesh) {
  Extent extent;
  for (const auto& [a, b, c] : mesh.triangles)
    extent.add(corner_of(mesh, a), corner_of(mesh, b), corner_of(mesh, c));
  return extent;
}

/// True if positions are multiples of 1/1024, and triangles lie in crossed voxels, which are sorted.
bool crosses_its_voxels(const ClippedMesh& clipped, const Grid& grid) {
  constexpr int kSteps = 40;
  for (const auto& position : clipped.surface.positions_ijk) {
    for (const float x : position)
      if (x * 1024 != std::round(x * 1024)) return false;
  }
  for (const auto& [a, b, c] : clipped.surface.triangles) {
    const Vec3 p = corner_of(clipped.surface, a), u = difference(corner_of(clipped.surface, b), p),
               v = difference(corner_of(clipped.surface, c), p);
    for (int n = 0; n < kSteps * kSteps; ++n) {
      const double s = (n % kSteps + 0.5) / kSteps, t = (1 - s) * (n / kSteps + 0.5) / kSteps;
      Index3 voxel;
      bool is_between = false;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x = p[axis] + s * u[axis] + t * v[axis] + 0.5;
        voxel[axis] = static_cast<std::int64_t>(std::floor(x));
        is_between = is_between || std::abs(x - std::round(x)) < 2.0 / 1024;
      }
      if (!is_between &&
          !std::ranges::binary_search(clipped.crossed, grid.offset(voxel[0], voxel[1], voxel[2])))
        return false;
    }
  }
  return std::ranges::is_sorted(clipped.crossed);
}

TEST(ClipMesh, APlaneThroughVoxelCentresCrossesExactlyThose) {
  // Two triangles make the square [1, 6] x [1, 6] at z = 3, between voxel centres.
  TriangleMesh mesh = triangle({1, 1, 3}, {6, 1, 3}, {6, 6, 3});
  mesh.positions_lps_mm.push_back({1, 6, 3});
  mesh.triangles.push_back({0, 2, 3});
  const Grid grid{.size = {8, 8, 8}};
  const auto clipped = value_or_throw(clip_mesh(mesh, grid));
  EXPECT_TRUE(crosses_its_voxels(clipped, grid));
  EXPECT_EQ(clipped.surface.triangles, mesh.triangles);
  EXPECT_EQ(clipped.crossed.size(), 36u);
  for (const std::int64_t v : clipped.crossed) EXPECT_EQ(v / 64, 3);
  EXPECT_DOUBLE_EQ(extent_of(clipped.surface).area, 25);
  EXPECT_EQ(clipped.outside, 0);
  EXPECT_EQ(clipped.surface.position_scale, 1024u);
  for (const auto& n : clipped.surface.normals_lps) EXPECT_EQ(n, (std::array<float, 3>{0, 0, 1}));
}

TEST(ClipMesh, APlaneBetweenVoxelsBelongsToTheUpperOnes) {
  const Grid grid{.size = {4, 4, 4}};
  for (const auto& [z, slice] : {std::pair<double, std::int64_t>{-0.5, 0}, {1.5, 2}, {3.5, 3}}) {
    const auto clipped = value_or_throw(clip_mesh(triangle({0, 0, z}, {2, 0, z}, {0, 2, z}), grid));
    EXPECT_TRUE(clipped.crossed.size() == 6 || z != 1.5) << clipped.crossed.size();
    EXPECT_DOUBLE_EQ(extent_of(clipped.surface).area, 2);
    for (const std::int64_t v : clipped.crossed) EXPECT_EQ(v / 16, slice);
  }
}

TEST(ClipMesh, WhatLiesBeyondTheGridIsCutOffAndTold) {
  const Grid grid{.size = {4, 4, 4}};
  // Half of the height of the triangle is outside: a quarter of its area lies beyond x = 3.5.
  const auto clipped = value_or_throw(clip_mesh(triangle({1.5, 0, 1}, {5.5, 0, 1}, {1.5, 2, 1}), grid));
  EXPECT_TRUE(crosses_its_voxels(clipped, grid));
  EXPECT_NEAR(clipped.outside, 0.25, 1e-12);
  EXPECT_NEAR(extent_of(clipped.surface).area, 3, 1e-3);
  const auto none = value_or_throw(clip_mesh(triangle({10, 0, 0}, {11, 0, 0}, {10, 1, 0}), grid));
  EXPECT_TRUE(none.crossed.empty());
  EXPECT_TRUE(none.surface.triangles.empty());
  EXPECT_EQ(none.outside, 1);
  // Corners a thousand kilometres away do no harm.
  const auto huge = value_or_throw(clip_mesh(triangle({-1e9, -1e9, 1}, {1e9, -1e9, 1}, {0, 1e9, 1}), grid));
  EXPECT_EQ(huge.crossed.size(), 16u);
  EXPECT_NEAR(extent_of(huge.surface).area, 16, 1e-3);
}

TEST(ClipMesh, NormalsAreTheFilesAndAreInterpolated) {
  TriangleMesh mesh = triangle({0, 0, 1}, {4, 0, 1}, {0, 4, 1});
  mesh.normals_lps = {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  const auto clipped = value_or_throw(clip_mesh(mesh, {.size = {2, 5, 3}}));
  bool found = false;
  for (std::size_t v = 0; v < clipped.surface.positions_ijk.size(); ++v) {
    const auto& [i, j, k] = clipped.surface.positions_ijk[v];
    if (i != 1.5f || j != 0) continue;
    const double t = 1.5 / 4, length = std::hypot(1 - t, t);
    EXPECT_NEAR(clipped.surface.normals_lps[v][0], (1 - t) / length, 1e-6);
    EXPECT_NEAR(clipped.surface.normals_lps[v][1], t / length, 1e-6);
    found = true;
  }
  EXPECT_TRUE(found);
}

/// A cube of 8 vertices and 12 triangles keeps its triangles. Each face has 4 vertices of its own.
TEST(ClipMesh, TheFacesOfACubeKeepTheirNormals) {
  constexpr std::size_t kEdge = 209;
  TriangleMesh cube;
  for (std::uint32_t v = 0; v < 8; ++v) {
    const auto at = [&](std::uint32_t axis) { return (v >> axis & 1) != 0 ? kEdge + 0.25 : 0.25; };
    cube.positions_lps_mm.push_back({at(0), at(1), at(2)});
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, far = 1u << axis;
    cube.triangles.insert(cube.triangles.end(), {{0, v, u}, {u, v, u + v}});
    cube.triangles.insert(cube.triangles.end(), {{far, far + u, far + v}, {far + u, far + u + v, far + v}});
  }
  const auto clipped = value_or_throw(clip_mesh(cube, {.size = {kEdge + 3, kEdge + 3, kEdge + 3}}));
  EXPECT_EQ(clipped.surface.triangles.size(), 12u);
  EXPECT_EQ(clipped.crossed.size(), (kEdge + 1) * (kEdge + 1) * 6 - 12 * (kEdge + 1) + 8);
  ASSERT_EQ(clipped.surface.positions_ijk.size(), 24u);
  for (std::size_t v = 0; v < 24; ++v) {
    const auto& position = clipped.surface.positions_ijk[v];
    const auto& normal = clipped.surface.normals_lps[v];
    const auto axis = static_cast<std::size_t>(std::ranges::find_if(normal, [](float n) { return n != 0; }) -
                                               normal.begin());
    EXPECT_EQ(std::ranges::count(normal, 0.f), 2);
    EXPECT_EQ(normal[axis], position[axis] > 1 ? 1.f : -1.f);
  }
}

TEST(ClipMesh, MillimetresBecomeIndices) {
  Grid grid = awkward_grid(0.2);
  grid.size = {9, 9, 9};
  const Affine to_mm = index_to_lps_mm(grid);
  const auto clipped = value_or_throw(clip_mesh(
      triangle(to_mm.apply({4, 4, 4}), to_mm.apply({4.25, 4, 4}), to_mm.apply({4, 4.25, 4})), grid));
  EXPECT_EQ(clipped.crossed, (std::vector<std::int64_t>{grid.offset(4, 4, 4)}));
  ASSERT_EQ(clipped.surface.positions_ijk.size(), 3u);
  EXPECT_EQ(clipped.surface.positions_ijk[1], (std::array<float, 3>{4.25f, 4, 4}));
}

RC_GTEST_PROP(ClipMesh, AClosedSurfaceStaysClosedAndKeepsAreaAndVolume, ()) {
  const Grid grid{.size = {6, 7, 8}};
  const auto coordinate = [](double n) {  // some exactly on voxel faces and centres
    return *rc::gen::oneOf(
        rc::gen::map(rc::gen::inRange(0, 2 * static_cast<int>(n) - 1), [](int h) { return 0.5 * h - 0.5; }),
        rc::gen::map(rc::gen::inRange(0, 10000), [n](int t) { return t * (n - 1) / 10000 - 0.25; }));
  };
  std::array<Vec3, 4> corners;
  for (Vec3& c : corners) c = {coordinate(6), coordinate(7), coordinate(8)};
  // Corners are multiples of the stored position scale: only cuts are rounded.
  for (Vec3& c : corners) {
    for (double& x : c) x = std::round(x * 1024) / 1024;
  }
  TriangleMesh mesh;
  mesh.positions_lps_mm.assign(corners.begin(), corners.end());
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};  // counter-clockwise seen from outside
  Extent whole;
  double thinnest = 1e9;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double before = whole.area;
    whole.add(corners[a], corners[b], corners[c]);
    thinnest = std::min(thinnest, whole.area - before);
  }
  RC_PRE(thinnest > 0.1);
  const auto clipped = clip_mesh(mesh, grid);
  RC_ASSERT(clipped.has_value());
  RC_ASSERT(crosses_its_voxels(*clipped, grid));
  RC_ASSERT(clipped->outside < 1e-9);
  // A cut moves a vertex by at most half a step of 1/1024 per axis.
  RC_ASSERT(std::abs(extent_of(clipped->surface).area - whole.area) < 0.02 * whole.area + 0.02);
  RC_ASSERT(std::abs(extent_of(clipped->surface).volume - whole.volume) < whole.area / 1024);
}

TEST(ClipMesh, NeighboursStayJoined) {
  // Triangles on both sides of an edge share its corner within the grid, and its cut at the border.
  TriangleMesh mesh = triangle({0.3, 0.2, 0.1}, {5.7, 4.1, 6.3}, {0.2, 5.9, 2.2});
  mesh.positions_lps_mm.push_back({6.1, 0.4, 1.3});
  mesh.triangles.push_back({1, 0, 3});
  const Grid grid{.size = {4, 4, 4}};
  TriangleMesh first = mesh, second = mesh;
  first.triangles = {mesh.triangles[0]};
  second.triangles = {mesh.triangles[1]};
  const auto on_edge = [&](const ClippedMesh& clipped) {
    std::set<std::array<float, 3>> points;
    for (const auto& p : clipped.surface.positions_ijk) {
      const double t = (p[0] - 0.3) / (5.7 - 0.3);
      const double dj = p[1] - (0.2 + t * (4.1 - 0.2)), dk = p[2] - (0.1 + t * (6.3 - 0.1));
      if (std::hypot(dj, dk) < 2.0 / 1024) points.insert(p);
    }
    return points;
  };
  const auto a = on_edge(*clip_mesh(first, grid)), b = on_edge(*clip_mesh(second, grid));
  EXPECT_EQ(a.size(), 2u);
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace splatlas
