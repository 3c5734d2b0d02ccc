// Tree files and their structure graphs.

#include "preprocess/structures/build_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/structures/graph_cases.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class BuildGraph : public GraphTest {};

TEST_F(BuildGraph, WithoutATreeAllAreRoots) {
  const auto placed = build("");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph.size(), 6u);
  EXPECT_EQ(placed->graph.roots().size(), 6u);
  EXPECT_THAT(placed->index_of_source, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(placed->graph[5].id, "Rest_of_brain");
  EXPECT_EQ(placed->graph[5].label, 6);
}

TEST_F(BuildGraph, AGyrusHasASideAndALobe) {
  const auto placed = build(
      "# two hierarchies\n"
      "Brain/Left hemisphere/*_L\n"
      "Brain/Right hemisphere/*_R\n"
      "Brain/Frontal lobe/code:2001-2999\n"
      "Brain/Cerebellum/vermis*\n"
      "Brain/rest OF brain\n");
  ASSERT_TRUE(placed) << placed.error().message;
  const StructureGraph& graph = placed->graph;
  EXPECT_THAT(parents_of(graph, "Precentral_L"), ElementsAre("Left hemisphere", "Frontal lobe"));
  EXPECT_THAT(parents_of(graph, "Insula_R"), ElementsAre("Right hemisphere"));
  EXPECT_THAT(names_below(graph, "Frontal lobe"),
              UnorderedElementsAre("Frontal lobe", "Precentral_L", "Precentral_R"));
  EXPECT_EQ(names_below(graph, "Brain").size(), 11u);  // 5 groups, 6 structures, each once
  EXPECT_THAT(graph.roots(), ElementsAre(named(graph, "Brain")));
  for (StructureIndex s = 0; s < 6; ++s)
    EXPECT_EQ(graph[placed->index_of_source[s]].name, sources_of_aal()[s].name);
  // Indices follow the file: the first hierarchy is one range of them.
  EXPECT_EQ(graph[0].name, "Brain");
  EXPECT_EQ(graph[1].name, "Left hemisphere");
  EXPECT_EQ(graph[2].name, "Precentral_L");
}

TEST_F(BuildGraph, AMemberMayNameAGroup) {
  const auto placed = build(
      "Brain/Cerebellum/Vermis\n"  // named before its definition
      "Brain/Midline/Vermis/Vermis_3\n"
      "Empty/\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(parents_of(placed->graph, "Vermis"), ElementsAre("Cerebellum", "Midline"));
  EXPECT_THAT(names_below(placed->graph, "Empty"), ElementsAre("Empty"));
  EXPECT_EQ(placed->graph.roots().size(), 2u + 5u);
}

TEST_F(BuildGraph, GroupsOfOneNameAreKnownByTheirPaths) {
  const auto placed = build("Left/zone 2/*_L\nRight/Zone 2/*_R\nLeft/zone 2/Vermis_3\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(names_below(placed->graph, "Left"),
              UnorderedElementsAre("Left", "zone 2", "Precentral_L", "Insula_L", "Vermis_3"));
  EXPECT_THAT(names_below(placed->graph, "Right"),
              UnorderedElementsAre("Right", "Zone 2", "Precentral_R", "Insula_R"));
  EXPECT_EQ(placed->graph[1].id, "zone_2");
  EXPECT_EQ(placed->graph[5].id, "Zone_2_2");
  EXPECT_TRUE(items("tree-lines-unused").empty());
}

TEST_F(BuildGraph, AMemberThatNamesSeveralGroupsIsLeftOut) {
  ASSERT_TRUE(build("Left/zone/*_L\nRight/zone/*_R\nAll/zone\nLeft/zone\n"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 3, \"zone\" (which is the name of 2 groups)"));
}

TEST_F(BuildGraph, MembersMayBeTerms) {
  const auto placed = build("A/reil_l\nB/Reil_*&*_R\nC/Lobus insularis\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(names_below(placed->graph, "A"), UnorderedElementsAre("A", "Insula_L"));
  EXPECT_THAT(names_below(placed->graph, "B"), UnorderedElementsAre("B", "Insula_R"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 3, \"Lobus insularis\""));  // fits two
}

TEST_F(BuildGraph, MembersMayBeLabels) {
  const auto placed = build("A/#5\nA/#77\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(names_below(placed->graph, "A"), UnorderedElementsAre("A", "Vermis_3"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 2, \"#77\""));
  EXPECT_THAT(error("A/#x\n"), HasSubstr("line 1: '#x' is no label"));
}

TEST_F(BuildGraph, LinesThatFitNothingAreCounted) {
  const auto placed = build("Brain/*_L\nBrain/*_X\nBrain/code:4000-4999\nBrain/code:2001&*_R\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(names_below(placed->graph, "Brain").size(), 3u);
  EXPECT_THAT(items("tree-lines-unused"),
              ElementsAre("line 2, \"*_X\"", "line 3, \"code:4000-4999\"", "line 4, \"code:2001&*_R\""));
}

TEST_F(BuildGraph, AStructureMayHoldOthers) {
  const auto placed = build("Insula_L/Vermis_3\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph.size(), 6u);
  EXPECT_THAT(parents_of(placed->graph, "Vermis_3"), ElementsAre("Insula_L"));
}

TEST_F(BuildGraph, ConditionsMayBeJoined) {
  const auto placed = build("A/code:2001-3999&*_L\nB/code:3001,9100-9199\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(names_below(placed->graph, "A"), UnorderedElementsAre("A", "Precentral_L", "Insula_L"));
  EXPECT_THAT(names_below(placed->graph, "B"), UnorderedElementsAre("B", "Insula_L", "Vermis_3"));
}

TEST_F(BuildGraph, ColorsSpreadOverALine) {
  const auto placed = build(
      "Brain/ color=#102030\n"
      "Brain/code:2001-3999 color=#000000-#030609\n"
      "Vermis_3 color=#abc\n");
  ASSERT_TRUE(placed) << placed.error().message;
  const auto color = [&](const char* name) { return placed->graph[named(placed->graph, name)].color; };
  EXPECT_EQ(color("Brain"), (Rgb{0x10, 0x20, 0x30}));
  EXPECT_EQ(color("Precentral_L"), (Rgb{0, 0, 0}));
  EXPECT_EQ(color("Precentral_R"), (Rgb{1, 2, 3}));
  EXPECT_EQ(color("Insula_L"), (Rgb{2, 4, 6}));
  EXPECT_EQ(color("Insula_R"), (Rgb{3, 6, 9}));
  EXPECT_EQ(color("Vermis_3"), (Rgb{0xaa, 0xbb, 0xcc}));
}

TEST_F(BuildGraph, IdsAreUnique) {
  std::vector<SourceStructure> siblings(3);
  for (SourceStructure& sibling : siblings) sibling.name = "Left lobe";
  siblings[2].name = "left-lobe";
  const auto placed = build_graph(siblings, {}, "", notes_);
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph[0].id, "Left_lobe");
  EXPECT_EQ(placed->graph[1].id, "Left_lobe_2");
  EXPECT_EQ(placed->graph[2].id, "left_lobe_3");
}

TEST_F(BuildGraph, TellsTheLineOfAFault) {
  EXPECT_THAT(error("# one\n\nBrain/Precentral\n"), AllOf(HasSubstr("line 3"), HasSubstr("Precentral")));
  EXPECT_THAT(error("Brain/code:4000-4999\n"), HasSubstr("4000-4999"));
  EXPECT_THAT(error("Brain/code:x\n"), HasSubstr("'x'"));
  EXPECT_THAT(error("Brain/code:3000-2000\n"), HasSubstr("3000-2000"));
  EXPECT_THAT(error("Brain//Insula_L\n"), HasSubstr("empty"));
  EXPECT_THAT(error("/Insula_L\n"), HasSubstr("empty"));
  EXPECT_THAT(error("B*/Insula_L\n"), HasSubstr("pattern"));
  EXPECT_THAT(error("Brain/Insula_L color=red\n"), AllOf(HasSubstr("line 1"), HasSubstr("red")));
  EXPECT_THAT(error("A/B/Insula_L\nA/B/A\n"), AllOf(HasSubstr("a.tree"), HasSubstr("cycle")));
  EXPECT_THAT(error("A/code:2001&*_R\n"), HasSubstr("code:2001&*_R"));
  EXPECT_THAT(error("Brain/A\tB/Insula_L\n"), AllOf(HasSubstr("line 1"), HasSubstr("a tab")));
  EXPECT_THAT(error(std::string(201, 'x') + "/Insula_L\n"), HasSubstr("201 characters"));
}

}  // namespace
}  // namespace splatlas
