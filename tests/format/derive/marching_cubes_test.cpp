#include "format/derive/marching_cubes.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace splatlas {
namespace {

bool is_inside(unsigned inside, unsigned corner) {
  return (inside >> corner & 1) != 0;
}

TEST(CellTriangles, HaveTheirCornersOnEveryEdgeThatCrossesAndOnNoOther) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    std::set<std::pair<unsigned, unsigned>> crossed, used;
    for (unsigned corner = 0; corner < 8; ++corner) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) == 0 && is_inside(inside, corner) != is_inside(inside, corner | 1u << axis))
          crossed.emplace(corner, axis);
      }
    }
    for (const auto& triangle : cell_triangles(static_cast<std::uint8_t>(inside))) {
      for (const CellEdge& edge : triangle) used.emplace(edge.corner, edge.axis);
    }
    EXPECT_EQ(used, crossed) << inside;
  }
}

TEST(CellTriangles, DoNotLieInAFaceThatTwoCellsShare) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    for (const auto& triangle : cell_triangles(static_cast<std::uint8_t>(inside))) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        for (const unsigned side : {0u, 1u}) {
          EXPECT_FALSE(std::ranges::all_of(triangle, [&](const CellEdge& edge) {
            return edge.axis != axis && (edge.corner >> axis & 1) == side;
          })) << inside;
        }
      }
    }
  }
}

TEST(CellTriangles, CutOffASingleCornerFacingAwayFromIt) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    for (const bool hole : {false, true}) {  // all corners but one are inside
      const unsigned inside = hole ? 255u ^ 1u << corner : 1u << corner;
      const auto triangles = cell_triangles(static_cast<std::uint8_t>(inside));
      ASSERT_EQ(triangles.size(), 1u);
      std::array<std::array<double, 3>, 3> p{};
      for (std::size_t n = 0; n < 3; ++n) {
        const CellEdge edge = triangles[0][n];
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

TEST(CellTriangles, KeepDiagonalCornersApart) {
  EXPECT_EQ(cell_triangles(0b00001001).size(), 2u);  // on a face
  EXPECT_EQ(cell_triangles(0b10000001).size(), 2u);  // of the cell
  EXPECT_EQ(cell_triangles(0b01101001).size(), 4u);  // every second corner
  EXPECT_EQ(cell_triangles(0b11110110).size(), 4u);  // a diagonal of empty corners: one loop of six edges
  EXPECT_TRUE(cell_triangles(0).empty());
  EXPECT_TRUE(cell_triangles(255).empty());
}

StructureCrop crop_of(const Index3& size, const std::vector<std::uint8_t>& mask) {
  StructureCrop crop = empty_crop({{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}});
  for (std::int64_t n = 0; n < static_cast<std::int64_t>(mask.size()); ++n) {
    const std::int64_t i = n % size[0], j = n / size[0] % size[1], k = n / size[0] / size[1];
    if (mask[static_cast<std::size_t>(n)] != 0)
      crop.parts[crop.offset(i + 1, j + 1, k + 1)] = StructureCrop::kBoundary;
  }
  return crop;
}

RC_GTEST_PROP(MarchingCubes, SurfacesAreClosedAndEncloseEveryVoxelByHalf, ()) {
  const Index3 size{*rc::gen::inRange<std::int64_t>(1, 7), *rc::gen::inRange<std::int64_t>(1, 7),
                    *rc::gen::inRange<std::int64_t>(1, 7)};
  const auto mask = *rc::gen::container<std::vector<std::uint8_t>>(
      static_cast<std::size_t>(size[0] * size[1] * size[2]), rc::gen::element<std::uint8_t>(0, 1));
  const MaskSurface surface = marching_cubes(crop_of(size, mask));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::uint32_t highest = 0;
  for (const auto& t : surface.triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      ++edges[{t[n], t[(n + 1) % 3]}];
      RC_ASSERT(t[n] <= highest);  // numbered by first use
      highest = std::max(highest, t[n] + 1);
    }
  }
  RC_ASSERT(highest == surface.positions_ijk.size());
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    RC_ASSERT(back != edges.end());
    RC_ASSERT(back->second == count);
  }
  // One vertex on each edge between a voxel inside and a neighbour outside, and no others.
  const std::set<std::array<float, 3>> positions(surface.positions_ijk.begin(), surface.positions_ijk.end());
  RC_ASSERT(positions.size() == surface.positions_ijk.size());
  std::set<std::array<float, 3>> expected;
  const auto inside = [&](const Index3& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= size[a]) return false;
    }
    return mask[static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0])] != 0;
  };
  for (std::int64_t k = -1; k < size[2]; ++k) {
    for (std::int64_t j = -1; j < size[1]; ++j) {
      for (std::int64_t i = -1; i < size[0]; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
          Index3 next{i, j, k};
          ++next[a];
          if (inside({i, j, k}) == inside(next)) continue;
          std::array<float, 3> at{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
          at[a] += 0.5f;
          expected.insert(at);
        }
      }
    }
  }
  RC_ASSERT(positions == expected);
}

}  // namespace
}  // namespace splatlas
