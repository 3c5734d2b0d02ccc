// Graphs of tables and JSON trees.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/structures/graph_cases.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class PlaceNodes : public GraphTest {};

TEST_F(PlaceNodes, PlacesTheRowsOfATable) {
  const auto placed = build(
      "id,name,parent,color\n100,Brain,,#010203\n101,Left,100,\n1,Precentral,101,\n3,Insula,101,\n"
      "102,Unused,100,\n77,Nothing,102,\n5,Vermis,Midline,\n6,Rest,200,\n");
  ASSERT_TRUE(placed) << placed.error().message;
  const StructureGraph& graph = placed->graph;
  EXPECT_THAT(names_below(graph, "Brain"), ElementsAre("Brain", "Left", "Precentral_L", "Insula_L"));
  EXPECT_THAT(parents_of(graph, "Vermis_3"), ElementsAre("Midline"));
  EXPECT_EQ(graph[named(graph, "Brain")].color, (Rgb{1, 2, 3}));
  EXPECT_EQ(graph.size(), 9u);  // 6 structures, 3 groups
  EXPECT_EQ(graph[0].name, "Brain");
  EXPECT_THAT(items("tree-entries-unused"), ElementsAre("\"Unused\"", "\"Nothing\""));
  EXPECT_THAT(items("tree-parents-unknown"), ElementsAre("\"id:200\" of \"Rest\""));
}

TEST_F(PlaceNodes, PlacesPathsOfIdsAndOfNames) {
  for (const char* table : {"id,name,structure_id_path\n9,Brain,/9/\n8,Side,/9/8/\n1,x,/9/8/1/\n2,y,/9/2/\n",
                            "label\tname\tpath\n1\tx\tBrain/Side\n2\ty\tBrain\n"}) {
    const auto placed = build(table);
    ASSERT_TRUE(placed) << placed.error().message;
    EXPECT_EQ(placed->graph.size(), 8u);
    EXPECT_THAT(names_below(placed->graph, "Brain"),
                UnorderedElementsAre("Brain", "Side", "Precentral_L", "Precentral_R"));
    EXPECT_THAT(parents_of(placed->graph, "Precentral_L"), ElementsAre("Side"));
  }
}

TEST_F(PlaceNodes, BreaksCirclesOfTables) {
  const auto placed = build("id,name,parent\n10,A,11\n11,B,10\n1,x,10\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(items("tree-circles"), ElementsAre("\"B\" of \"A\""));
  EXPECT_THAT(names_below(placed->graph, "A"), ElementsAre("A", "Precentral_L"));
}

/// A group may have the name of its member, whose voxels it does not take.
TEST_F(PlaceNodes, KeepsGroupsApartFromMembersOfTheirName) {
  const auto placed =
      build("label,id,name,parent\n,100,Precentral_L,\n1,101,Precentral_L,100\n2,102,y,100\n");
  ASSERT_TRUE(placed) << placed.error().message;
  std::vector<bool> have_labels;
  for (const Structure& structure : placed->graph.structures()) {
    if (structure.name == "Precentral_L") have_labels.push_back(structure.label.has_value());
  }
  EXPECT_THAT(have_labels, ElementsAre(false, true));
}

TEST_F(PlaceNodes, PlacesMasksByTheNamesOfATable) {
  std::vector<SourceStructure> masks(2);
  masks[0].name = "heart", masks[1].name = "aorta";
  write_bytes(folder_.file("a.csv"), "id,name,parent\n51,Heart,Thorax\n52,Aorta,Thorax\n");
  const auto lines = read_tree(folder_.file("a.csv"), notes_);
  ASSERT_TRUE(lines);
  const auto placed = build_graph(masks, *lines, "a.csv", notes_);
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(names_below(placed->graph, "Thorax"), UnorderedElementsAre("Thorax", "heart", "aorta"));
}

TEST_F(PlaceNodes, RefusesTreesOfOtherLabels) {
  EXPECT_THAT(
      error("id,name,parent\n70,x,\n71,y,70\n"),
      HasSubstr("a.tree: none of its 2 entries fits a structure by label or name; the first is \"x\""));
  EXPECT_THAT(error("Brain/Precentral\nBrain/*_X\n"),
              AllOf(HasSubstr("a.tree: line 1: "), HasSubstr("no line fits")));
  EXPECT_THAT(error("{\"1\": \"spleen\"}"), HasSubstr("is no tree of the Allen Brain Atlas"));
}

}  // namespace
}  // namespace splatlas
