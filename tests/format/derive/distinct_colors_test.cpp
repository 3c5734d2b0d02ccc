#include "format/derive/distinct_colors.h"

#include <map>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_content.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

using Neighbors = std::vector<std::vector<StructureIndex>>;
constexpr std::size_t kColors = 12;
constexpr double kLeast = 0.112;  // distance of two colours of the palette

/// Neighbours of structures that fill a volume; `structure_at(index)` is kNoStructure in empty voxels.
template <typename StructureAt>
Neighbors touching(const Index3& size, std::size_t structures, const StructureAt& structure_at) {
  ClassTable classes;
  std::vector<ClassId> volume;
  for_each_voxel(size, [&](const Index3& at) {
    const StructureIndex s = structure_at(at);
    volume.push_back(s == kNoStructure ? kEmptyClass : classes.intern({{s, Part::kBoundary}}));
  });
  const RunModel model = encode_runs(volume, size, Axis::kZ, classes.size());
  return touching_structures(structures, classes, model.classes, size);
}

TEST(TouchingStructures, OfARowOfBoxesAreThoseBesideThem) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Index3 size{1, 1, 1};
    size[axis] = 11;  // boxes of two voxels, and a gap behind the third
    const Neighbors found = touching(size, 5, [&](const Index3& at) {
      const auto n = static_cast<StructureIndex>(at[axis]);
      return n == 6 ? kNoStructure : (n > 6 ? n - 1 : n) / 2;
    });
    EXPECT_EQ(found, (Neighbors{{1}, {0, 2}, {1}, {4}, {3}})) << axis;
  }
}

TEST(TouchingStructures, OfACheckerboardShareFacesAndNotEdges) {
  constexpr std::int64_t kCells = 4;
  const auto number = [](const Index3& cell) {
    return static_cast<StructureIndex>(cell[0] + kCells * (cell[1] + kCells * cell[2]));
  };
  const Neighbors found = touching({2 * kCells, 2 * kCells, 2 * kCells}, 64, [&](const Index3& at) {
    return number({at[0] / 2, at[1] / 2, at[2] / 2});
  });
  Neighbors expected(64);
  for_each_voxel({kCells, kCells, kCells}, [&](const Index3& cell) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Index3 next = cell;
      if (++next[axis] == kCells) continue;
      expected[number(cell)].push_back(number(next));
      expected[number(next)].push_back(number(cell));
    }
  });
  for (auto& of : expected) std::ranges::sort(of);
  EXPECT_EQ(found, expected);
}

RC_GTEST_PROP(TouchingStructures, AreThoseOfAllPairsOfVoxels, ()) {
  std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
  const AtlasContent content = random_content(random);
  const Index3 size = storage_grid(content).size;
  const auto members = [&](const Index3& at) {
    return content.classes.members(
        content.class_volume[static_cast<std::size_t>(at[0] + size[0] * (at[1] + size[1] * at[2]))]);
  };
  std::vector<std::set<StructureIndex>> expected(content.graph.size());
  for_each_voxel(size, [&](const Index3& at) {
    for (std::size_t axis = 0; axis < 4; ++axis) {  // 3: the voxel itself
      Index3 next = at;
      if (axis < 3 && ++next[axis] == size[axis]) continue;
      for (const Membership& a : members(at)) {
        for (const Membership& b : members(next)) {
          if (a.structure == b.structure) continue;
          expected[a.structure].insert(b.structure);
          expected[b.structure].insert(a.structure);
        }
      }
    }
  });
  const RunModel model = encode_runs(content.class_volume, size, Axis::kZ, content.classes.size());
  const Neighbors found = touching_structures(content.graph.size(), content.classes, model.classes, size);
  for (StructureIndex s = 0; s < found.size(); ++s)
    RC_ASSERT(std::set(found[s].begin(), found[s].end()) == expected[s]);
}

TEST(ColorDistance, IsThatOfOklab) {
  for (const Sight sight : kSights) EXPECT_NEAR(color_distance({0, 0, 0}, {255, 255, 255}, sight), 1, 1e-6);
  // Red is (0.627955, 0.224863, 0.125846), Ottosson 2020
  EXPECT_NEAR(color_distance({255, 0, 0}, {0, 0, 0}, Sight::kNormal), 0.678769, 1e-5);
  // On lines of confusion; without one kind of cones, these differ by rounding alone
  EXPECT_LT(color_distance({89, 149, 149}, {203, 131, 149}, Sight::kProtanopia), 0.005);
  EXPECT_LT(color_distance({89, 170, 149}, {203, 121, 152}, Sight::kDeuteranopia), 0.005);
  EXPECT_GT(color_distance({89, 149, 149}, {203, 131, 149}, Sight::kNormal), 0.15);
  EXPECT_GT(color_distance({89, 170, 149}, {203, 121, 152}, Sight::kNormal), 0.15);
}

/// Everyone beside everyone.
Neighbors clique(StructureIndex count) {
  Neighbors all(count);
  for (StructureIndex a = 0; a < count; ++a) {
    for (StructureIndex b = 0; b < count; ++b)
      if (a != b) all[a].push_back(b);
  }
  return all;
}

TEST(DistinctColors, KeepNeighboursApartForAllSights) {
  const Neighbors neighbors = clique(kColors);
  const std::vector<Rgb> colors = distinct_colors(neighbors, std::vector<std::optional<Rgb>>(kColors));
  for (StructureIndex a = 0; a < kColors; ++a) {
    for (const StructureIndex b : neighbors[a])
      for (const Sight sight : kSights) EXPECT_GE(color_distance(colors[a], colors[b], sight), kLeast);
  }
}

TEST(DistinctColors, AreUsedEquallyOften) {
  std::map<std::string, int> uses;
  for (const Rgb color : distinct_colors(Neighbors(36), std::vector<std::optional<Rgb>>(36)))
    ++uses[to_hex(color)];
  EXPECT_EQ(uses.size(), kColors);
  for (const auto& [color, count] : uses) EXPECT_EQ(count, 3) << color;
}

TEST(DistinctColors, AreShadesOfWishesApartForAllSights) {
  for (const Rgb wish : {Rgb{0xe6, 0xdc, 0xc3}, {0xc8, 0x35, 0x2e}, {0x3d, 0x62, 0xad}, {0xa5, 0x49, 0x3f}}) {
    const std::vector<std::optional<Rgb>> given(3), wishes(3, wish);
    const std::vector<Rgb> colors = distinct_colors(clique(3), given, wishes);
    EXPECT_EQ(colors[0], wish);
    for (const Sight sight : kSights) {
      for (std::size_t n = 0; n < 3; ++n)
        EXPECT_GE(color_distance(colors[n], colors[(n + 1) % 3], sight), kLeast) << to_hex(wish);
    }
    EXPECT_EQ(distinct_colors(Neighbors(3), given, wishes), std::vector(3, wish));
  }
}

TEST(DistinctColors, StayWhereGivenAndKeepAwayFromThese) {
  const Neighbors neighbors = clique(kColors);
  const std::vector<Rgb> palette = distinct_colors(neighbors, std::vector<std::optional<Rgb>>(kColors));
  std::vector<std::optional<Rgb>> given(palette.begin(), palette.end());
  given[7].reset();  // only its own colour is left
  given[3] = Rgb{1, 2, 3};
  std::vector<Rgb> expected = palette;
  expected[3] = {1, 2, 3};
  const Rgb found = distinct_colors(neighbors, given)[7];
  expected[7] = found;
  EXPECT_TRUE(found == palette[7] || found == palette[3]);
  EXPECT_EQ(distinct_colors(neighbors, given), expected);
}

}  // namespace
}  // namespace splatlas
