// Tree files and their structure graphs.

#include "preprocess/structures/build_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/raw_image_files.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// Six structures with names and codes in the style of AAL.
std::vector<SourceStructure> sources() {
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
    result.push_back(source);
  }
  return result;
}

class BuildGraph : public testing::Test {
 protected:
  Result<PlacedStructures> build(const std::string& tree) const {
    write_bytes(folder_.file("a.tree"), tree);
    const auto lines = read_tree(folder_.file("a.tree"));
    if (!lines) return tl::unexpected(lines.error());
    return build_graph(sources(), *lines, "a.tree");
  }
  std::string error(const std::string& tree) const {
    const auto placed = build(tree);
    return placed ? "no error" : placed.error().message;
  }
  TemporaryFolder folder_;
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
  for (StructureIndex s = 0; s < 6; ++s) EXPECT_EQ(graph[placed->index_of_source[s]].name, sources()[s].name);
  // Indices follow the file: the first hierarchy is one range of them.
  EXPECT_EQ(graph[0].name, "Brain");
  EXPECT_EQ(graph[1].name, "Left hemisphere");
  EXPECT_EQ(graph[2].name, "Precentral_L");
}

TEST_F(BuildGraph, AGroupMayStandBelowSeveral) {
  const auto placed = build(
      "Brain/Cerebellum/Vermis\n"  // named before its definition
      "Brain/Midline/Vermis/Vermis_3\n"
      "Empty/\n");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_THAT(parents_of(placed->graph, "Vermis"), ElementsAre("Cerebellum", "Midline"));
  EXPECT_THAT(names_below(placed->graph, "Empty"), ElementsAre("Empty"));
  EXPECT_EQ(placed->graph.roots().size(), 2u + 5u);
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
  const auto placed = build_graph(siblings, {}, "");
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph[0].id, "Left_lobe");
  EXPECT_EQ(placed->graph[1].id, "Left_lobe_2");
  EXPECT_EQ(placed->graph[2].id, "left_lobe_3");
}

TEST_F(BuildGraph, TellsTheLineOfAFault) {
  EXPECT_THAT(error("Brain/*_L\nBrain/*_X\n"), AllOf(HasSubstr("a.tree: line 2"), HasSubstr("*_X")));
  EXPECT_THAT(error("# one\n\nBrain/Precentral\n"), AllOf(HasSubstr("line 3"), HasSubstr("Precentral")));
  EXPECT_THAT(error("Brain/code:4000-4999\n"), HasSubstr("4000-4999"));
  EXPECT_THAT(error("Brain/code:x\n"), HasSubstr("'x'"));
  EXPECT_THAT(error("Brain/code:3000-2000\n"), HasSubstr("3000-2000"));
  EXPECT_THAT(error("Brain//Insula_L\n"), HasSubstr("empty"));
  EXPECT_THAT(error("/Insula_L\n"), HasSubstr("empty"));
  EXPECT_THAT(error("B*/Insula_L\n"), HasSubstr("pattern"));
  EXPECT_THAT(error("Brain/Insula_L color=red\n"), AllOf(HasSubstr("line 1"), HasSubstr("red")));
  EXPECT_THAT(error("A/B/Insula_L\nB/A/\n"), AllOf(HasSubstr("a.tree"), HasSubstr("cycle")));
  EXPECT_THAT(error("A/code:2001&*_R\n"), HasSubstr("code:2001&*_R"));
  EXPECT_THAT(error("Brain/A\tB/Insula_L\n"), AllOf(HasSubstr("line 1"), HasSubstr("a tab")));
  EXPECT_THAT(error(std::string(201, 'x') + "/Insula_L\n"), HasSubstr("201 characters"));
}

}  // namespace
}  // namespace splatlas
