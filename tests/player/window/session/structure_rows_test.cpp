#include "player/window/session/structure_rows.h"

#include <map>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"
#include "tests/player/window/two_sided_graph.h"

namespace splatlas {
namespace {

using testing::ElementsAre;
using two_sided::Index;

std::vector<StructureIndex> structures_of(const StructureRows& rows) {
  std::vector<StructureIndex> structures;
  for (const StructureRow& row : rows.rows()) structures.push_back(row.structure);
  return structures;
}

/// Opens every branch once.
void open_all(StructureRows& rows) {
  for (std::size_t n = 0; n < rows.rows().size(); ++n) {
    const StructureRow row = rows.rows()[n];
    if (row.has_children && !row.open) rows.toggle(row);
  }
}

/// A root with `branches` children of `leaves` children each.
StructureGraph comb(std::size_t branches, std::size_t leaves) {
  std::vector<Structure> structures(1);
  structures[0].id = "root";
  const auto add = [&](StructureIndex parent) {
    Structure structure;
    structure.id = "s" + std::to_string(structures.size());
    structure.parents = {parent};
    structures.push_back(std::move(structure));
    return static_cast<StructureIndex>(structures.size() - 1);
  };
  for (std::size_t b = 0; b < branches; ++b) {
    const StructureIndex branch = add(0);
    for (std::size_t l = 0; l < leaves; ++l) add(branch);
  }
  return *StructureGraph::build(std::move(structures));
}

/// Closes all branches.
void close_all(StructureRows& rows) {
  for (std::size_t n = rows.rows().size(); n-- > 0;) {
    const StructureRow row = rows.rows()[n];
    if (row.open) rows.toggle(row);
  }
}

TEST(StructureRowsTest, OpensLevelByLevelWhileThereAreFewRows) {
  EXPECT_EQ(StructureRows(comb(3, 4)).rows().size(), 1u + 3 + 12);
  EXPECT_EQ(StructureRows(comb(3, 10)).rows().size(), 1u + 3 + 2 * 10);  // the third would exceed the limit
  EXPECT_EQ(StructureRows(comb(100, 1)).rows().size(), 1u);
}

TEST(StructureRowsTest, RowsKnowDepthAndChildren) {
  const StructureGraph graph = two_sided::graph();
  StructureRows rows(graph);
  close_all(rows);
  ASSERT_EQ(rows.rows().size(), 1u);
  EXPECT_FALSE(rows.rows()[0].open);
  rows.toggle(rows.rows()[0]);
  EXPECT_THAT(structures_of(rows),
              ElementsAre(Index::kBrain, Index::kLeft, Index::kRight, Index::kLobe, Index::kStem));
  EXPECT_TRUE(rows.rows()[0].open);
  EXPECT_EQ(rows.rows()[1].depth, 1);
  EXPECT_TRUE(rows.rows()[1].has_children);
  EXPECT_FALSE(rows.rows()[4].has_children);
}

TEST(StructureRowsTest, AStructureStandsUnderEachOfItsParents) {
  const StructureGraph graph = two_sided::graph();
  StructureRows rows(graph);
  open_all(rows);
  EXPECT_THAT(structures_of(rows),
              ElementsAre(Index::kBrain, Index::kLeft, Index::kGyrusLeft, Index::kRight, Index::kGyrusRight,
                          Index::kLobe, Index::kGyrusLeft, Index::kGyrusRight, Index::kStem));
  EXPECT_NE(rows.rows()[2].place, rows.rows()[6].place);
  rows.toggle(rows.rows()[5]);  // only the lobe closes
  EXPECT_THAT(structures_of(rows), ElementsAre(Index::kBrain, Index::kLeft, Index::kGyrusLeft, Index::kRight,
                                               Index::kGyrusRight, Index::kLobe, Index::kStem));
}

TEST(StructureRowsTest, RevealsByTheFirstParents) {
  const StructureGraph graph = two_sided::graph();
  StructureRows rows(graph);
  close_all(rows);
  const std::size_t row = rows.reveal(Index::kGyrusRight);
  EXPECT_THAT(structures_of(rows), ElementsAre(Index::kBrain, Index::kLeft, Index::kRight, Index::kGyrusRight,
                                               Index::kLobe, Index::kStem));
  EXPECT_EQ(row, 3u);
  EXPECT_EQ(rows.reveal(Index::kStem), 5u);  // already visible
}

TEST(StructureRowsTest, SearchFindsAllWordsInNamesAndIdsWhateverTheirCase) {
  const StructureGraph graph = two_sided::graph();
  StructureRows rows(graph);
  rows.search("RIGHT gy");
  EXPECT_THAT(structures_of(rows), ElementsAre(Index::kGyrusRight));
  rows.search("gyrus_l");
  EXPECT_THAT(structures_of(rows), ElementsAre(Index::kGyrusLeft));
  rows.search("left");  // prefix matches come first
  EXPECT_THAT(structures_of(rows), ElementsAre(Index::kLeft, Index::kGyrusLeft));
  rows.search("nothing");
  EXPECT_TRUE(rows.rows().empty());
  rows.search("  ");
  EXPECT_FALSE(rows.searching());
  EXPECT_EQ(rows.rows().size(), 9u);
}

TEST(StructureRowsTest, RevealEndsASearchThatHidesTheStructure) {
  const StructureGraph graph = two_sided::graph();
  StructureRows rows(graph);
  rows.search("stem");
  EXPECT_EQ(rows.reveal(Index::kStem), 0u);
  EXPECT_TRUE(rows.searching());
  EXPECT_EQ(rows.rows()[rows.reveal(Index::kGyrusLeft)].structure, Index::kGyrusLeft);
  EXPECT_FALSE(rows.searching());
}

RC_GTEST_PROP(StructureRowsProperty, AllOpenThereIsARowForEveryPath, ()) {
  std::mt19937 random = *random_source();
  const StructureGraph graph = random_graph(1 + random() % 9, random);
  StructureRows rows(graph);
  open_all(rows);
  std::map<StructureIndex, std::size_t> count;
  for (const StructureRow& row : rows.rows()) ++count[row.structure];
  std::set<std::uint64_t> places;
  for (const StructureRow& row : rows.rows()) places.insert(row.place);
  RC_ASSERT(places.size() == rows.rows().size());
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    RC_ASSERT(count[s] == graph.paths(s, 100000).size());
  }
}

RC_GTEST_PROP(StructureRowsProperty, RevealReturnsARowOfTheStructure, ()) {
  std::mt19937 random = *random_source();
  const StructureGraph graph = random_graph(1 + random() % 9, random);
  StructureRows rows(graph);
  for (int n = 0; n < 4; ++n) {
    const auto s = static_cast<StructureIndex>(random() % graph.size());
    RC_ASSERT(rows.rows().at(rows.reveal(s)).structure == s);
    rows.toggle(rows.rows()[random() % rows.rows().size()]);
  }
}

}  // namespace
}  // namespace splatlas
