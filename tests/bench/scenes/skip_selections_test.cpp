#include "bench/scenes/skip_selections.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

std::ptrdiff_t drawn(const Selection& selection) {
  return std::ranges::count_if(selection.structures,
                               [](const StructureDraw& draw) { return draw.mode != DrawMode::kOff; });
}

TEST(ManySelections, AreEveryStructureAndRandomLeaves) {
  const auto graph = StructureGraph::build({{.id = "all"},
                                            {.id = "left", .parents = {0}},
                                            {.id = "right", .parents = {0}},
                                            {.id = "a", .parents = {1}},
                                            {.id = "b", .parents = {1, 2}}});
  ASSERT_TRUE(graph);
  const StructureDraw draw{.mode = DrawMode::kVolume};
  const auto selections = many_selections(*graph, draw, 3);
  ASSERT_EQ(selections.size(), 5u + 3);
  EXPECT_EQ(drawn(selections[0].selection), 5);
  EXPECT_EQ(drawn(selections[1].selection), 3);
  EXPECT_EQ(drawn(selections[2].selection), 2);
  EXPECT_EQ(drawn(selections[4].selection), 1);
  for (std::size_t n = 5; n < selections.size(); ++n) {
    const auto& structures = selections[n].selection.structures;
    EXPECT_GE(drawn(selections[n].selection), 1);
    for (const StructureIndex group : {0u, 1u, 2u}) EXPECT_EQ(structures[group].mode, DrawMode::kOff);
  }
  EXPECT_EQ(many_selections(*graph, draw, 3)[6].selection, selections[6].selection);
}

}  // namespace
}  // namespace splatlas
