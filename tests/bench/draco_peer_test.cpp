#include "bench/peers/draco_peer.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

/// A plane of 2 n^2 triangles.
SurfaceMesh plane(std::uint32_t n) {
  SurfaceMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      mesh.positions_ijk.push_back({static_cast<float>(i), static_cast<float>(j), 0});
      mesh.normals_lps.push_back({0, 0, 1});
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      mesh.triangles.push_back({v, v + 1, v + n + 2});
      mesh.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  }
  return mesh;
}

TEST(DracoPeer, CodesAPlaneInLessThanAByteATriangleAndNormalsBesides) {
  const SurfaceMesh mesh = plane(64);
  const auto file = draco_peer::encode(mesh, {});
  ASSERT_TRUE(file.has_value());
  EXPECT_GT(file->size(), 100u);
  EXPECT_LT(file->size(), mesh.triangles.size());
  EXPECT_EQ(*draco_peer::decode(*file), mesh.triangles.size());
  const auto finer = draco_peer::encode(mesh, {.position_bits = 14});
  const auto with_normals = draco_peer::encode(mesh, {.normal_bits = 8});
  ASSERT_TRUE(finer.has_value() && with_normals.has_value());
  EXPECT_GT(finer->size(), file->size());
  EXPECT_GT(with_normals->size(), file->size());
}

TEST(DracoPeer, TakesNothingForASurfaceWithoutTriangles) {
  const auto file = draco_peer::encode(SurfaceMesh{}, {});
  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(file->empty());
  EXPECT_EQ(*draco_peer::decode(*file), 0u);
}

TEST(DracoPeer, TellsWhatIsNoFileOfItsOwn) {
  EXPECT_FALSE(draco_peer::decode(std::vector<std::byte>(100)).has_value());
}

}  // namespace
}  // namespace splatlas
