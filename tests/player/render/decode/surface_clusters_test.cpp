// Clusters of triangles: nothing is lost or changed, and borders are found.
#include "player/render/decode/surface_clusters.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/marching_tetrahedra.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

constexpr Grid kClusterGrid{{20, 24, 28}, {1, 2, 0.5}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

SurfaceMesh noise_mesh(unsigned seed) {
  std::mt19937 random(seed);
  return marching_tetrahedra(make_mask(kClusterGrid.size, [&](auto...) { return random() % 3 == 0; }),
                             kClusterGrid);
}

TEST(SurfaceClusters, HoldEachTriangleOnceWithItsCorners) {
  const SurfaceMesh mesh = noise_mesh(1);
  const SurfaceClusters clusters(mesh, kClusterGrid);
  std::vector<int> seen(mesh.triangles.size());
  float sides = 0;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const SurfaceClusters::Cluster cluster = clusters[c];
    ASSERT_LE(cluster.triangles.size(), SurfaceClusters::kMaxTriangles);
    for (std::uint32_t n = 0; n < cluster.triangles.size(); ++n) {
      const std::uint32_t number = clusters.number(cluster.first + n);
      ++seen[number];
      const auto normals = clusters.normals(cluster.first + n);
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = mesh.triangles[number][corner];
        const auto& position = cluster.positions_ijk[cluster.triangles[n].corners[corner]];
        EXPECT_EQ(position, mesh.positions_ijk[vertex]);
        EXPECT_TRUE(std::equal(normals[corner], normals[corner] + 3, mesh.normals_lps[vertex].begin()));
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_GE(position[a], cluster.box.low[a]);
          EXPECT_LE(position[a], cluster.box.high[a]);
        }
      }
    }
    sides += *std::ranges::max_element(cluster.box.high) - *std::ranges::min_element(cluster.box.low);
  }
  EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(mesh.triangles.size()));
  EXPECT_GT(mesh.triangles.size(), 10000u);
  // Neighbours stay together: 64 triangles of noise fill a few voxels of the 28
  EXPECT_LT(sides / static_cast<float>(clusters.size()), 16);
}

TEST(SurfaceClusters, KnowTheFrontByNormalsAndWinding) {
  SurfaceMesh mesh;
  mesh.positions_ijk = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  using Front = SurfaceClusters::Front;
  const std::array<std::pair<float, std::array<Front, 2>>, 3> kCases{
      {{1.0f, {Front::kCounterClockwise, Front::kClockwise}},
       {-1.0f, {Front::kClockwise, Front::kCounterClockwise}},
       {0.0f, {Front::kBoth, Front::kBoth}}}};
  for (const auto& [z, fronts] : kCases) {
    mesh.normals_lps.assign(3, {0, 0, z});
    const SurfaceClusters clusters(mesh, kClusterGrid);
    for (std::uint32_t n = 0; n < 2; ++n)
      EXPECT_EQ(clusters[0].triangles[n].front, fronts[clusters.number(n)]) << z << ", " << n;
  }
  // The winding of derived surfaces is right where the normal of a small triangle is not
  mesh.position_scale = static_cast<std::uint32_t>(SurfaceRule::kSmooth);
  const SurfaceClusters derived(mesh, kClusterGrid);
  for (const SurfaceClusters::Triangle& of : derived[0].triangles)
    EXPECT_EQ(of.front, Front::kCounterClockwise);
}

TEST(SurfaceClusters, AreClosedWithoutABorderOnly) {
  SurfaceMesh mesh = noise_mesh(2);
  EXPECT_FALSE(SurfaceClusters(mesh, kClusterGrid).is_closed());  // not fitted
  mesh.position_scale = static_cast<std::uint32_t>(SurfaceRule::kSmooth);
  EXPECT_TRUE(SurfaceClusters(mesh, kClusterGrid).is_closed());
  SurfaceMesh turned = mesh;
  std::swap(turned.triangles[7][0], turned.triangles[7][1]);
  EXPECT_FALSE(SurfaceClusters(turned, kClusterGrid).is_closed());
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  EXPECT_FALSE(SurfaceClusters(mesh, kClusterGrid).is_closed());
}

/// Files may hold any number: nothing is divided by a size of 0, and no box is infinite.
TEST(SurfaceClusters, TakeCoordinatesThatAreNotFinite) {
  SurfaceMesh mesh;
  const float infinity = std::numeric_limits<float>::infinity(),
              nan = std::numeric_limits<float>::quiet_NaN();
  mesh.positions_ijk = {{nan, 0, 0}, {infinity, -infinity, 3}, {2, 2, 2}};
  mesh.normals_lps.assign(3, {0, 0, nan});
  mesh.triangles = {{0, 1, 2}, {2, 2, 2}};
  const SurfaceClusters clusters(mesh, kClusterGrid);
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_EQ(clusters[0].box.high, (std::array<float, 3>{2, 2, 3}));
  EXPECT_EQ(SurfaceClusters(SurfaceMesh{}, kClusterGrid).size(), 0u);
}

}  // namespace
}  // namespace splatlas
