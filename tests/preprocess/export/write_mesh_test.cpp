#include "preprocess/export/write_mesh.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

const std::vector<Corners> kWritten{{{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}},
                                    {{{1, 1, 1}, {5, 5, 5}, {9, 9, 9}}},  // without area
                                    {{{-123.456789, 7, 0}, {10, 0, 3}, {0, 10, 0}}}};

TriangleMesh file_with(const std::vector<Corners>& triangles) {
  TriangleMesh mesh;
  for (const Corners& corners : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.positions_lps_mm.size());
    mesh.positions_lps_mm.insert(mesh.positions_lps_mm.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(CompareMesh, TakesSixDigitsAndMissingTrianglesWithoutArea) {
  EXPECT_TRUE(holds_triangles(file_with(kWritten), kWritten));
  EXPECT_TRUE(holds_triangles(file_with({kWritten[0], kWritten[2]}), kWritten));
  auto rounded = kWritten;
  rounded[2][0][0] = -123.457;
  EXPECT_TRUE(holds_triangles(file_with(rounded), kWritten));
}

TEST(CompareMesh, TellsLostAndChangedTriangles) {
  EXPECT_FALSE(holds_triangles(file_with({kWritten[0]}), kWritten));
  EXPECT_FALSE(holds_triangles(file_with({kWritten[2]}), kWritten));
  EXPECT_FALSE(holds_triangles(file_with({kWritten[2], kWritten[0]}), kWritten));
  EXPECT_FALSE(holds_triangles(file_with({kWritten[0], kWritten[1], kWritten[2], kWritten[2]}), kWritten));
  auto changed = kWritten;
  changed[2][0][0] = -123.46;
  EXPECT_FALSE(holds_triangles(file_with(changed), kWritten));
  auto turned = kWritten;
  std::swap(turned[0][1], turned[0][2]);
  EXPECT_FALSE(holds_triangles(file_with(turned), kWritten));
}

}  // namespace
}  // namespace splatlas
