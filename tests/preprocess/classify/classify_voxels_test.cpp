#include "preprocess/classify/classify_voxels.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/preprocess/random_images.h"
#include "tests/support/fails_with.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

using Members = std::vector<Membership>;

Members members_of(const ClassTable& classes, ClassId c) {
  const auto members = classes.members(c);
  return {members.begin(), members.end()};
}

Members expected_members(const Masks& masks, const Index3& size, std::span<const CrossedVoxel> crossed,
                         std::int64_t voxel) {
  const std::int64_t i = voxel % size[0], j = voxel / size[0] % size[1], k = voxel / (size[0] * size[1]);
  Members members;
  for (StructureIndex s = 0; s < masks.size(); ++s) {
    if (masks[s][static_cast<std::size_t>(voxel)] == 0) continue;
    members.push_back(
        {s, is_boundary({i, j, k}, holds_in(masks[s], size)) ? Part::kBoundary : Part::kInterior});
  }
  for (const CrossedVoxel& c : crossed) {
    if (c.voxel == voxel) members.push_back({c.structure, Part::kCrossed});
  }
  std::sort(members.begin(), members.end());
  return members;
}

TEST(ClassifyVoxels, BeyondTheGridIsOutside) {
  const Index3 size{4, 4, 4};
  const Masks all{std::vector<std::uint8_t>(64, 1)};
  const auto result = value_or_throw(classify_voxels(memberships_of(all, size), {}, flat_graph(1)));
  ASSERT_EQ(result.classes.size(), 3u);
  EXPECT_EQ(result.classes.voxels(kEmptyClass), 0u);
  EXPECT_EQ(result.classes.voxels(1), 8u);   // the 2x2x2 core
  EXPECT_EQ(result.classes.voxels(2), 56u);  // the shell
}

TEST(ClassifyVoxels, OneOverlappedByAnotherKeepsItsOwnBoundary) {
  // B within A: B's voxels are interior of A wherever A goes on around them.
  const Index3 size{9, 9, 9};
  const auto box = [&](std::int64_t low, std::int64_t high) {
    return make_mask(size, [=](auto i, auto j, auto k) {
      return std::min({i, j, k}) >= low && std::max({i, j, k}) <= high;
    });
  };
  const auto result =
      value_or_throw(classify_voxels(memberships_of({box(1, 7), box(3, 5)}, size), {}, flat_graph(2)));
  std::map<Members, std::uint64_t> counts;
  for (ClassId c = 0; c < result.classes.size(); ++c) {
    counts[members_of(result.classes, c)] = result.classes.voxels(c);
  }
  const std::map<Members, std::uint64_t> expected{{{}, 729 - 343},
                                                  {{{0, Part::kBoundary}}, 343 - 125},
                                                  {{{0, Part::kInterior}}, 125 - 27},
                                                  {{{0, Part::kInterior}, {1, Part::kBoundary}}, 26},
                                                  {{{0, Part::kInterior}, {1, Part::kInterior}}, 1}};
  EXPECT_EQ(counts, expected);
}

TEST(ClassifyVoxels, MoreThan64StructuresInOneVoxelAreRefused) {
  const Masks masks(65, std::vector<std::uint8_t>{1});
  EXPECT_THAT(classify_voxels(memberships_of(masks, {1, 1, 1}), {}, flat_graph(65)),
              FailsWith(ErrorCode::kLimit, testing::_));
}

RC_GTEST_PROP(ClassifyVoxels, EveryVoxelHasTheClassOfTheDefinition, ()) {
  const Index3 size{*rc::gen::inRange<std::int64_t>(1, 8), *rc::gen::inRange<std::int64_t>(1, 8),
                    *rc::gen::inRange<std::int64_t>(1, 8)};
  const std::int64_t voxels = size[0] * size[1] * size[2];
  const auto structures = *rc::gen::inRange<std::size_t>(0, 4);
  // Mostly inside, so that interiors occur. One structure only: the disjoint case.
  const int density = *rc::gen::inRange(1, 30);
  Masks masks;
  for (std::size_t s = 0; s < structures; ++s) {
    masks.push_back(*rc::gen::container<std::vector<std::uint8_t>>(
        static_cast<std::size_t>(voxels),
        rc::gen::map(rc::gen::inRange(0, density + 1), [](int n) { return std::uint8_t{n != 0}; })));
  }
  std::vector<CrossedVoxel> crossed;
  const auto crossings = *rc::gen::inRange<std::size_t>(0, 20);
  for (std::size_t n = 0; n < crossings; ++n) {
    crossed.push_back({*rc::gen::inRange<std::int64_t>(0, voxels),
                       static_cast<StructureIndex>(structures + *rc::gen::inRange<std::size_t>(0, 2))});
  }
  std::sort(crossed.begin(), crossed.end());
  crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());

  const StructureGraph graph = flat_graph(structures + 2);
  const MembershipVolume memberships = memberships_of(masks, size);
  const auto result = classify_voxels(memberships, crossed, graph, 1);
  RC_ASSERT(result.has_value());
  const std::vector<ClassId> volume = volume_of(*result, size);
  std::vector<std::uint64_t> counts(result->classes.size(), 0);
  std::vector<IndexBox> boxes(result->classes.size());
  for (std::int64_t v = 0; v < voxels; ++v) {
    const ClassId c = volume[static_cast<std::size_t>(v)];
    RC_ASSERT(members_of(result->classes, c) == expected_members(masks, size, crossed, v));
    ++counts[c];
    const Index3 voxel{v % size[0], v / size[0] % size[1], v / (size[0] * size[1])};
    boxes[c].include({voxel, voxel});
  }
  for (ClassId c = 0; c < counts.size(); ++c) {
    RC_ASSERT(result->classes.voxels(c) == counts[c]);
    RC_ASSERT(result->classes.box(c) == boxes[c]);
    RC_ASSERT(c == kEmptyClass || counts[c] > 0u);
  }
  const std::vector<ClassId> order = storage_order(result->classes, graph);
  RC_ASSERT(std::is_sorted(order.begin(), order.end()));
  const auto threaded = classify_voxels(memberships, crossed, graph, 3);
  RC_ASSERT(threaded->runs == result->runs);
}

}  // namespace
}  // namespace splatlas
