#include "format/derive/cell_cases.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

using Triangle = std::array<CellEdge, 3>;

bool is_inside(unsigned inside, unsigned corner) {
  return (inside >> corner & 1) != 0;
}

std::vector<Triangle> triangles(unsigned inside) {
  const CellCase& of = cell_cases()[inside];
  std::vector<Triangle> all;
  for (std::size_t t = 0; t < of.triangle_count; ++t) {
    Triangle& triangle = all.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) triangle[n] = cell_edge(of.edges[of.triangles[t][n]]);
  }
  return all;
}
TEST(CellEdges, HaveTheNumbersOfTheFormat) {
  // By axis, then by corner
  const std::vector<unsigned> corners{0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};
  for (std::size_t n = 0; n < kCellEdges; ++n) {
    EXPECT_EQ(cell_edge(n).corner, corners[n]);
    EXPECT_EQ(cell_edge(n).axis, n / 4);
    EXPECT_EQ(number_of(cell_edge(n)), n);
  }
}

TEST(CellCases, TrianglesHaveTheirCornersOnEveryEdgeThatCrossesAndOnNoOther) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    std::set<std::pair<unsigned, unsigned>> crossed, used;
    for (unsigned corner = 0; corner < 8; ++corner) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) == 0 && is_inside(inside, corner) != is_inside(inside, corner | 1u << axis))
          crossed.emplace(corner, axis);
      }
    }
    for (const auto& triangle : triangles(inside)) {
      for (const CellEdge& edge : triangle) used.emplace(edge.corner, edge.axis);
    }
    EXPECT_EQ(used, crossed) << inside;
    EXPECT_EQ(cell_cases()[inside].edge_count, crossed.size()) << inside;
  }
}

TEST(CellCases, TrianglesDoNotLieInAFaceThatTwoCellsShare) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    for (const auto& triangle : triangles(inside)) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        for (const unsigned side : {0u, 1u}) {
          EXPECT_FALSE(std::ranges::all_of(triangle, [&](const CellEdge& edge) {
            return edge.axis != axis && (edge.corner >> axis & 1u) == side;
          })) << inside;
        }
      }
    }
  }
}

TEST(CellCases, CutOffASingleCornerFacingAwayFromIt) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    for (const bool hole : {false, true}) {  // all corners but one are inside
      const unsigned inside = hole ? 255u ^ 1u << corner : 1u << corner;
      const auto all = triangles(inside);
      ASSERT_EQ(all.size(), 1u);
      std::array<std::array<double, 3>, 3> p{};
      for (std::size_t n = 0; n < 3; ++n) {
        const CellEdge edge = all[0][n];
        for (unsigned a = 0; a < 3; ++a) p[n][a] = (edge.corner >> a & 1) + (edge.axis == a ? 0.5 : 0);
      }
      double along = 0;  // of the normal, towards the corner
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        const double normal =
            (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
        along += normal * ((corner >> a & 1) - p[0][a]);
      }
      EXPECT_EQ(along > 0, hole) << corner;
    }
  }
}

TEST(CellCases, KeepDiagonalCornersApart) {
  EXPECT_EQ(triangles(0b00001001).size(), 2u);  // on a face
  EXPECT_EQ(triangles(0b10000001).size(), 2u);  // of the cell
  EXPECT_EQ(triangles(0b01101001).size(), 4u);  // every second corner
  EXPECT_EQ(triangles(0b11110110).size(), 4u);  // a diagonal of empty corners: one loop of six edges
  EXPECT_TRUE(triangles(0).empty());
  EXPECT_TRUE(triangles(255).empty());
}

/// CRC-32 of zlib and PNG.
std::uint32_t crc32(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320u : 0);
  }
  return ~crc;
}

TEST(CellCases, HaveTheChecksumOfTheFormatDescription) {
  std::vector<std::uint8_t> bytes;
  for (unsigned inside = 0; inside < 256; ++inside) {
    const auto all = triangles(inside);
    bytes.push_back(static_cast<std::uint8_t>(all.size()));
    for (const Triangle& triangle : all) {
      for (const CellEdge& edge : triangle) bytes.push_back(static_cast<std::uint8_t>(number_of(edge)));
    }
  }
  EXPECT_EQ(bytes.size(), 2716u);
  EXPECT_EQ(crc32(bytes), 0x2f135cb0u);
}

}  // namespace
}  // namespace splatlas
