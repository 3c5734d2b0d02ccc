
#include <gtest/gtest.h>

#include "format/derive/surface_net.h"

namespace splatlas {
namespace {

using Triangle = std::array<CellEdge, 3>;

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
