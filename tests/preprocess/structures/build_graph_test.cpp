// Structure graphs of tree files, tables and JSON trees.

#include "preprocess/structures/build_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using testing::UnorderedElementsAre;

/// Six structures with names and codes in the style of AAL.
std::vector<SourceStructure> sources_of_aal() {
  std::vector<SourceStructure> result;
  for (const auto& [name, code] : {std::pair<const char*, int>{"Precentral_L", 2001},
                                   {"Precentral_R", 2002},
                                   {"Insula_L", 3001},
                                   {"Insula_R", 3002},
                                   {"Vermis_3", 9110},
                                   {"Rest of brain", 0}}) {
    SourceStructure source;
    source.name = name;
    source.label = static_cast<std::int64_t>(result.size()) + 1;
    if (code != 0) source.code = code;
    if (code / 1000 == 3)
      source.terms = {{"la", "Lobus insularis"}, {"synonym", "Reil" + source.name.substr(6)}};
    result.push_back(source);
  }
  return result;
}

class GraphTest : public testing::Test {
 protected:
  Result<PlacedStructures> build(const std::string& tree) {
    write_bytes(folder_.file("a.tree"), tree);
    notes_ = {};
    const auto lines = read_tree(folder_.file("a.tree"), notes_);
    if (!lines) return tl::unexpected(lines.error());
    return build_graph(sources_of_aal(), *lines, "a.tree", notes_);
  }
  std::string error(const std::string& tree) {
    const auto placed = build(tree);
    return placed ? "no error" : placed.error().message;
  }
  /// Items of a kind of notes.
  [[nodiscard]] std::vector<std::string> items(const std::string& kind) const {
    return items_of(notes_, kind);
  }
  TemporaryFolder folder_;
  Notes notes_;
};

StructureIndex named(const StructureGraph& graph, const std::string& name) {
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (graph[s].name == name) return s;
  }
  ADD_FAILURE() << "no structure " << name;
  return 0;
}

std::vector<std::string> parents_of(const StructureGraph& graph, const std::string& name) {
  std::vector<std::string> parents;
  for (const StructureIndex p : graph[named(graph, name)].parents) parents.push_back(graph[p].name);
  return parents;
}

std::vector<std::string> names_below(const StructureGraph& graph, const std::string& name) {
  std::vector<std::string> names;
  for (const StructureIndex s : graph.descendants(named(graph, name))) names.push_back(graph[s].name);
  return names;
}

class BuildGraph : public GraphTest {};

TEST_F(BuildGraph, WithoutATreeAllAreRoots) {
  const auto placed = value_or_throw(build(""));
  EXPECT_EQ(placed.graph.size(), 6u);
  EXPECT_EQ(placed.graph.roots().size(), 6u);
  EXPECT_THAT(placed.index_of_source, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(placed.graph[5].id, "Rest_of_brain");
  EXPECT_EQ(placed.graph[5].label, 6);
}

TEST_F(BuildGraph, AGyrusHasASideAndALobe) {
  const auto placed =
      value_or_throw(build("# two hierarchies\n"
                           "Brain/Left hemisphere/*_L\n"
                           "Brain/Right hemisphere/*_R\n"
                           "Brain/Frontal lobe/code:2001-2999\n"
                           "Brain/Cerebellum/vermis*\n"
                           "Brain/rest OF brain\n"));
  const StructureGraph& graph = placed.graph;
  EXPECT_THAT(parents_of(graph, "Precentral_L"), ElementsAre("Left hemisphere", "Frontal lobe"));
  EXPECT_THAT(parents_of(graph, "Insula_R"), ElementsAre("Right hemisphere"));
  EXPECT_THAT(names_below(graph, "Frontal lobe"),
              UnorderedElementsAre("Frontal lobe", "Precentral_L", "Precentral_R"));
  EXPECT_EQ(names_below(graph, "Brain").size(), 11u);  // 5 groups, 6 structures, each once
  EXPECT_THAT(graph.roots(), ElementsAre(named(graph, "Brain")));
  for (StructureIndex s = 0; s < 6; ++s)
    EXPECT_EQ(graph[placed.index_of_source[s]].name, sources_of_aal()[s].name);
  // Indices follow the file: the first hierarchy is one range of them.
  EXPECT_EQ(graph[0].name, "Brain");
  EXPECT_EQ(graph[1].name, "Left hemisphere");
  EXPECT_EQ(graph[2].name, "Precentral_L");
}

TEST_F(BuildGraph, AMemberMayNameAGroup) {
  const auto placed =
      value_or_throw(build("Brain/Cerebellum/Vermis\n"  // named before its definition
                           "Brain/Midline/Vermis/Vermis_3\n"
                           "Empty/\n"));
  EXPECT_THAT(parents_of(placed.graph, "Vermis"), ElementsAre("Cerebellum", "Midline"));
  EXPECT_THAT(names_below(placed.graph, "Empty"), ElementsAre("Empty"));
  EXPECT_EQ(placed.graph.roots().size(), 2u + 5u);
}

TEST_F(BuildGraph, GroupsOfOneNameAreKnownByTheirPaths) {
  const auto placed = value_or_throw(build("Left/zone 2/*_L\nRight/Zone 2/*_R\nLeft/zone 2/Vermis_3\n"));
  EXPECT_THAT(names_below(placed.graph, "Left"),
              UnorderedElementsAre("Left", "zone 2", "Precentral_L", "Insula_L", "Vermis_3"));
  EXPECT_THAT(names_below(placed.graph, "Right"),
              UnorderedElementsAre("Right", "Zone 2", "Precentral_R", "Insula_R"));
  EXPECT_EQ(placed.graph[1].id, "zone_2");
  EXPECT_EQ(placed.graph[5].id, "Zone_2_2");
  EXPECT_TRUE(items("tree-lines-unused").empty());
}

TEST_F(BuildGraph, AMemberThatNamesSeveralGroupsIsLeftOut) {
  ASSERT_TRUE(build("Left/zone/*_L\nRight/zone/*_R\nAll/zone\nLeft/zone\n"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 3, \"zone\" (which is the name of 2 groups)"));
}

TEST_F(BuildGraph, MembersMayBeTerms) {
  const auto placed = value_or_throw(build("A/reil_l\nB/Reil_*&*_R\nC/Lobus insularis\n"));
  EXPECT_THAT(names_below(placed.graph, "A"), UnorderedElementsAre("A", "Insula_L"));
  EXPECT_THAT(names_below(placed.graph, "B"), UnorderedElementsAre("B", "Insula_R"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 3, \"Lobus insularis\""));  // fits two
}

TEST_F(BuildGraph, MembersMayBeLabels) {
  const auto placed = value_or_throw(build("A/#5\nA/#77\n"));
  EXPECT_THAT(names_below(placed.graph, "A"), UnorderedElementsAre("A", "Vermis_3"));
  EXPECT_THAT(items("tree-lines-unused"), ElementsAre("line 2, \"#77\""));
  EXPECT_THAT(error("A/#x\n"), HasSubstr("line 1: '#x' is no label"));
}

TEST_F(BuildGraph, LinesThatFitNothingAreCounted) {
  const auto placed =
      value_or_throw(build("Brain/*_L\nBrain/*_X\nBrain/code:4000-4999\nBrain/code:2001&*_R\n"));
  EXPECT_EQ(names_below(placed.graph, "Brain").size(), 3u);
  EXPECT_THAT(items("tree-lines-unused"),
              ElementsAre("line 2, \"*_X\"", "line 3, \"code:4000-4999\"", "line 4, \"code:2001&*_R\""));
}

TEST_F(BuildGraph, AStructureMayHoldOthers) {
  const auto placed = value_or_throw(build("Insula_L/Vermis_3\n"));
  EXPECT_EQ(placed.graph.size(), 6u);
  EXPECT_THAT(parents_of(placed.graph, "Vermis_3"), ElementsAre("Insula_L"));
}

TEST_F(BuildGraph, ConditionsMayBeJoined) {
  const auto placed = value_or_throw(build("A/code:2001-3999&*_L\nB/code:3001,9100-9199\n"));
  EXPECT_THAT(names_below(placed.graph, "A"), UnorderedElementsAre("A", "Precentral_L", "Insula_L"));
  EXPECT_THAT(names_below(placed.graph, "B"), UnorderedElementsAre("B", "Insula_L", "Vermis_3"));
}

TEST_F(BuildGraph, ColorsSpreadOverALine) {
  const auto placed =
      value_or_throw(build("Brain/ color=#102030\n"
                           "Brain/code:2001-3999 color=#000000-#030609\n"
                           "Vermis_3 color=#abc\n"));
  const auto color = [&](const char* name) { return placed.graph[named(placed.graph, name)].color; };
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
  const auto placed = value_or_throw(build_graph(siblings, {}, "", notes_));
  EXPECT_EQ(placed.graph[0].id, "Left_lobe");
  EXPECT_EQ(placed.graph[1].id, "Left_lobe_2");
  EXPECT_EQ(placed.graph[2].id, "left_lobe_3");
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

class PlaceNodes : public GraphTest {};

TEST_F(PlaceNodes, PlacesTheRowsOfATable) {
  const auto placed = value_or_throw(
      build("id,name,parent,color\n100,Brain,,#010203\n101,Left,100,\n1,Precentral,101,\n3,Insula,101,\n"
            "102,Unused,100,\n77,Nothing,102,\n5,Vermis,Midline,\n6,Rest,200,\n"));
  const StructureGraph& graph = placed.graph;
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
    const auto placed = value_or_throw(build(table));
    EXPECT_EQ(placed.graph.size(), 8u);
    EXPECT_THAT(names_below(placed.graph, "Brain"),
                UnorderedElementsAre("Brain", "Side", "Precentral_L", "Precentral_R"));
    EXPECT_THAT(parents_of(placed.graph, "Precentral_L"), ElementsAre("Side"));
  }
}

TEST_F(PlaceNodes, BreaksCirclesOfTables) {
  const auto placed = value_or_throw(build("id,name,parent\n10,A,11\n11,B,10\n1,x,10\n"));
  EXPECT_THAT(items("tree-circles"), ElementsAre("\"B\" of \"A\""));
  EXPECT_THAT(names_below(placed.graph, "A"), ElementsAre("A", "Precentral_L"));
}

/// A group may have the name of its member, whose voxels it does not take.
TEST_F(PlaceNodes, KeepsGroupsApartFromMembersOfTheirName) {
  const auto placed = value_or_throw(
      build("label,id,name,parent\n,100,Precentral_L,\n1,101,Precentral_L,100\n2,102,y,100\n"));
  std::vector<bool> have_labels;
  for (const Structure& structure : placed.graph.structures()) {
    if (structure.name == "Precentral_L") have_labels.push_back(structure.label.has_value());
  }
  EXPECT_THAT(have_labels, ElementsAre(false, true));
}

TEST_F(PlaceNodes, PlacesMasksByTheNamesOfATable) {
  std::vector<SourceStructure> masks(2);
  masks[0].name = "heart", masks[1].name = "aorta";
  write_bytes(folder_.file("a.csv"), "id,name,parent\n51,Heart,Thorax\n52,Aorta,Thorax\n");
  const auto lines = value_or_throw(read_tree(folder_.file("a.csv"), notes_));
  const auto placed = value_or_throw(build_graph(masks, lines, "a.csv", notes_));
  EXPECT_THAT(names_below(placed.graph, "Thorax"), UnorderedElementsAre("Thorax", "heart", "aorta"));
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
