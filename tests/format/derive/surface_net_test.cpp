#include "format/derive/surface_net.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/derive/masks.h"
#include "tests/format/random_volume.h"
#include "tests/support/closed_mesh.h"

namespace splatlas {
namespace {

/// Noise, long runs or a checkerboard in up to 6^3 voxels, or in a long row: words of 64 voxels.
Mask patterned_mask(std::mt19937& random) {
  Mask mask;
  for (std::int64_t& n : mask.size) n = 1 + static_cast<std::int64_t>(below(6, random));
  if (below(3, random) == 0) mask.size[0] = 60 + static_cast<std::int64_t>(below(80, random));
  for (const ClassId c : random_classes(mask.size, 2, random)) mask.held.push_back(c != 0 ? 1 : 0);
  return mask;
}

/// A midpoint of a voxel edge.
std::array<float, 3> midpoint(const NetVertex& vertex) {
  std::array<float, 3> at{static_cast<float>(vertex.voxel[0]), static_cast<float>(vertex.voxel[1]),
                          static_cast<float>(vertex.voxel[2])};
  at[vertex.axis()] += 0.5f;
  return at;
}

/// Ids of 32 bits would overflow, before or after hundreds of gigabytes.
TEST(SurfaceNet, RefusesMoreVerticesThanIds) {
  EXPECT_THROW(NetBuilder(NetBuilder::kMaxVertices + 1), std::bad_alloc);
}

RC_GTEST_PROP(SurfaceNet, IsClosedAndHasOneVertexOnEveryCrossedEdge, ()) {
  auto random = *random_source();
  const Mask mask = patterned_mask(random);
  const SurfaceNet net = surface_net(crop_of(mask));
  RC_ASSERT(is_closed(net.triangles));
  std::uint32_t highest = 0;
  for (const auto& t : net.triangles) {
    for (const std::uint32_t vertex : t) {
      RC_ASSERT(vertex <= highest);  // numbered by first use
      highest = std::max(highest, vertex + 1);
    }
  }
  RC_ASSERT(highest == net.vertices.size());
  RC_ASSERT(net.neighbours.size() == net.vertices.size() && net.kinds.size() == net.vertices.size());
  std::set<std::array<float, 3>> positions, expected;
  for (const NetVertex& vertex : net.vertices) {
    positions.insert(midpoint(vertex));
    RC_ASSERT(mask.holds({vertex.voxel[0], vertex.voxel[1], vertex.voxel[2]}) == (vertex.first_is_inside()));
  }
  RC_ASSERT(positions.size() == net.vertices.size());
  for (std::int64_t k = -1; k < mask.size[2]; ++k) {
    for (std::int64_t j = -1; j < mask.size[1]; ++j) {
      for (std::int64_t i = -1; i < mask.size[0]; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
          Index3 next{i, j, k};
          ++next[a];
          if (mask.holds({i, j, k}) == mask.holds(next)) continue;
          std::array<float, 3> at{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
          at[a] += 0.5f;
          expected.insert(at);
        }
      }
    }
  }
  RC_ASSERT(positions == expected);
}

/// Triangles in the order of the slow definition: cells by leading voxel, then by cell.
RC_GTEST_PROP(SurfaceNet, TrianglesAreSortedByTheLeadingVoxelOfTheirCell, ()) {
  auto random = *random_source();
  const Mask mask = patterned_mask(random);
  StructureCrop crop = crop_of(mask);
  if (below(2, random) == 0) {  // wrong parts
    for (std::uint8_t& part : crop.parts) {
      if (part != StructureCrop::kOutside && below(3, random) == 0) part = StructureCrop::kInterior;
    }
  }
  std::vector<std::array<std::size_t, 3>> places;  // leading voxel plus 1, cell, inside corners
  for (std::int64_t k = 0; k + 1 < crop.size[2]; ++k) {
    for (std::int64_t j = 0; j + 1 < crop.size[1]; ++j) {
      for (std::int64_t i = 0; i + 1 < crop.size[0]; ++i) {
        std::size_t leading = 0, inside = 0;
        for (std::int64_t corner = 7; corner >= 0; --corner) {
          const std::size_t at = crop.offset(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
          if (crop.parts[at] == StructureCrop::kBoundary) leading = at + 1;
          if (crop.parts[at] != StructureCrop::kOutside) inside |= std::size_t{1} << corner;
        }
        places.push_back({leading, crop.offset(i, j, k), inside});
      }
    }
  }
  std::ranges::sort(places);
  const SurfaceNet net = surface_net(crop);
  std::size_t next = 0;
  for (const auto& [leading, cell, inside] : places) {
    const CellCase& of = cell_cases()[inside];
    const auto at = static_cast<std::int64_t>(cell);
    const Index3 corner{at % crop.size[0] + crop.first[0], at / crop.size[0] % crop.size[1] + crop.first[1],
                        at / crop.size[0] / crop.size[1] + crop.first[2]};
    for (std::size_t t = 0; t < of.triangle_count; ++t, ++next) {
      RC_ASSERT(next < net.triangles.size());
      for (std::size_t n = 0; n < 3; ++n) {
        const CellEdge edge = cell_edge(of.edges[of.triangles[t][n]]);
        const NetVertex& vertex = net.vertices[net.triangles[next][n]];
        for (std::size_t a = 0; a < 3; ++a) RC_ASSERT(vertex.voxel[a] == corner[a] + (edge.corner >> a & 1));
        RC_ASSERT(vertex.axis() == edge.axis);
      }
    }
  }
  RC_ASSERT(next == net.triangles.size());
}

TEST(SurfaceNet, IgnoresVoxelsInThePaddingOfACrop) {
  StructureCrop crop = crop_of(mask_of({2, 2, 2}, [](auto, auto, auto) { return true; }));
  std::ranges::fill(crop.parts, StructureCrop::kBoundary);
  EXPECT_EQ(surface_net(crop).vertices.size(), 24u);
}

}  // namespace
}  // namespace splatlas
