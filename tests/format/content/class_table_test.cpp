#include "format/content/class_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

using Members = std::vector<Membership>;
constexpr Part kInterior = Part::kInterior;
constexpr Part kBoundary = Part::kBoundary;
constexpr Part kCrossed = Part::kCrossed;

Members members_of(const ClassTable& table, ClassId c) {
  return {table.members(c).begin(), table.members(c).end()};
}

TEST(ClassTable, ClassZeroIsTheEmptyOne) {
  ClassTable table;
  EXPECT_EQ(table.size(), 1u);
  EXPECT_TRUE(table.members(kEmptyClass).empty());
  EXPECT_EQ(table.voxels(kEmptyClass), 0u);
  EXPECT_TRUE(table.box(kEmptyClass).empty());
  EXPECT_EQ(table.intern({}), kEmptyClass);
}

TEST(ClassTable, OneClassPerCombinationInWhateverOrder) {
  ClassTable table;
  const ClassId a = table.intern({{3, kInterior}, {1, kBoundary}});
  EXPECT_EQ(a, 1u);
  EXPECT_EQ(table.intern({{1, kBoundary}, {3, kInterior}}), a);
  EXPECT_EQ(table.intern({{1, kInterior}, {3, kInterior}}), 2u);
  EXPECT_EQ(table.intern({{1, kBoundary}}), 3u);
  EXPECT_EQ(table.size(), 4u);
  EXPECT_EQ(members_of(table, a), (Members{{1, kBoundary}, {3, kInterior}}));
}

TEST(ClassTable, RepeatsMerge) {
  ClassTable table;
  const ClassId interior = table.intern({{2, kInterior}});
  const ClassId boundary = table.intern({{2, kBoundary}});
  const ClassId crossed = table.intern({{2, kCrossed}});
  EXPECT_EQ(table.intern({{2, kInterior}, {2, kInterior}}), interior);
  EXPECT_EQ(table.intern({{2, kBoundary}, {2, kInterior}}), boundary);
  EXPECT_EQ(table.intern({{2, kCrossed}, {2, kCrossed}}), crossed);
  EXPECT_EQ(table.intern({{2, kCrossed}, {2, kInterior}}), boundary);  // held, and a surface passes through
  EXPECT_EQ(table.intern({{2, kInterior}, {2, kBoundary}, {2, kCrossed}, {2, kInterior}}), boundary);
  EXPECT_EQ(table.size(), 4u);
}

TEST(ClassTable, CountsVoxelsAndBoxes) {
  ClassTable table;
  const ClassId c = table.intern({{0, kInterior}});
  table.count(c, 5, {{3, 4, 5}, {6, 4, 9}});
  table.count(c, 0, {});
  table.count(c, 2, {{4, 2, 8}, {4, 3, 11}});
  EXPECT_EQ(table.voxels(c), 7u);
  EXPECT_EQ(table.box(c), (IndexBox{{3, 2, 5}, {6, 4, 11}}));
  EXPECT_EQ(table.voxels(kEmptyClass), 0u);
}

TEST(ClassTable, RenumberingCarriesEverything) {
  ClassTable table;
  const ClassId a = table.intern({{0, kInterior}});
  const ClassId b = table.intern({{0, kBoundary}, {1, kBoundary}});
  table.count(kEmptyClass, 100, {{0, 0, 0}, {9, 9, 9}});
  table.count(a, 1, {{1, 1, 1}, {1, 1, 1}});
  table.count(b, 2, {{2, 2, 2}, {2, 2, 3}});
  const ClassTable renumbered = table.renumbered(std::vector<ClassId>{0, b, a});
  EXPECT_EQ(members_of(renumbered, 1), members_of(table, b));
  EXPECT_EQ(members_of(renumbered, 2), members_of(table, a));
  EXPECT_EQ(renumbered.voxels(0), 100u);
  EXPECT_EQ(renumbered.voxels(1), 2u);
  EXPECT_EQ(renumbered.box(2), table.box(a));
  ClassTable again = renumbered;
  EXPECT_EQ(again.intern({{0, kInterior}}), 2u);
}

TEST(ClassStorageOrder, FollowsThePreorderInteriorBeforeBoundary) {
  // Preorder: brain (0), left (2), gyrus (1), right (3).
  const auto graph = value_or_throw(StructureGraph::build({{.id = "brain"},
                                                           {.id = "gyrus", .parents = {2}},
                                                           {.id = "left", .parents = {0}},
                                                           {.id = "right", .parents = {0}}}));
  ASSERT_THAT(std::vector(graph.preorder().begin(), graph.preorder().end()),
              testing::ElementsAre(0, 2, 1, 3));
  const std::vector<Members> expected{
      {},
      {{0, kInterior}, {3, kInterior}},
      {{0, kBoundary}},
      {{2, kInterior}},
      {{2, kInterior}, {1, kInterior}},
      {{2, kInterior}, {1, kBoundary}},
      {{2, kBoundary}},
      {{1, kInterior}},
      {{1, kCrossed}},
      {{3, kInterior}},
  };
  std::vector<std::size_t> first_seen(expected.size() - 1);
  std::iota(first_seen.begin(), first_seen.end(), 1u);
  std::mt19937 random(1);
  for (int n = 0; n < 20; ++n) {  // in any order of insertion
    std::shuffle(first_seen.begin(), first_seen.end(), random);
    ClassTable table;
    for (const std::size_t e : first_seen) table.intern(expected[e]);
    const ClassTable stored = table.renumbered(storage_order(table, graph));
    ASSERT_EQ(stored.size(), expected.size());
    for (ClassId c = 0; c < stored.size(); ++c) {
      Members sorted = expected[c];
      std::sort(sorted.begin(), sorted.end());
      EXPECT_EQ(members_of(stored, c), sorted) << c;
    }
  }
}

RC_GTEST_PROP(ClassStorageOrder, DependsOnTheCombinationsAlone, ()) {
  const auto n = *uniform<std::size_t>(1, 10);
  auto random = *random_source();
  const StructureGraph graph = random_graph(n, random);
  std::vector<Members> combinations(30);
  for (Members& members : combinations) {
    for (StructureIndex s = 0; s < n; ++s) {
      if (random() % 3 == 0) members.push_back({s, static_cast<Part>(random() % 3)});
    }
  }
  const auto stored = [&] {
    ClassTable table;
    for (const Members& members : combinations) table.intern(members);
    const auto order = storage_order(table, graph);
    std::vector<Members> result;
    const ClassTable renumbered = table.renumbered(order);
    for (ClassId c = 0; c < renumbered.size(); ++c) result.push_back(members_of(renumbered, c));
    RC_ASSERT(order.size() == table.size());
    RC_ASSERT(order[0] == kEmptyClass);
    return result;
  };
  const auto first = stored();
  std::shuffle(combinations.begin(), combinations.end(), random);
  RC_ASSERT(stored() == first);

  // The classes of a subtree are a range, by their first structure.
  std::vector<std::size_t> rank(n);
  for (std::size_t place = 0; place < n; ++place) rank[graph.preorder()[place]] = place;
  std::size_t before = 0;
  for (std::size_t c = 1; c < first.size(); ++c) {
    std::size_t first_rank = n;
    for (const Membership& m : first[c]) first_rank = std::min(first_rank, rank[m.structure]);
    RC_ASSERT(first_rank >= before);
    before = first_rank;
  }
}

}  // namespace
}  // namespace splatlas
