#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/content/selection.h"
#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

Selection without_term_numbers(Selection selection) {
  for (StructureDraw& draw : selection.structures) draw.term = 0;
  return selection;
}

/// Brain > (Left > (A, B), Right > C), and a lobe of A and C.
StructureGraph brain() {
  return *StructureGraph::build({
      {.id = "Brain", .name = "Brain", .color = {255, 0, 0}},
      {.id = "Left", .name = "Left", .color = {0, 255, 0}, .parents = {0}},
      {.id = "Right", .name = "Right", .color = {0, 0, 255}, .parents = {0}},
      {.id = "A", .name = "Area A", .color = {1, 1, 1}, .parents = {1, 6}},
      {.id = "B-1", .name = "Area B", .color = {2, 2, 2}, .parents = {1}},
      {.id = "C", .name = "Area C", .color = {3, 3, 3}, .parents = {2, 6}},
      {.id = "Lobe", .name = "Lobe", .color = {4, 4, 4}},
  });
}

TEST(SelectionText, IsShort) {
  const StructureGraph graph = brain();
  // Canonical texts, which come back unchanged.
  for (const char* text : {
           "",
           "Brain",
           "Left:surface",
           "\"B-1\":both",
           "A(opacity=0.4)",
           "Left:surface(opacity=0.25,color=#ff8800)",
           "Brain - A",
           "Brain - Left",
           "Brain - Left + A",
           "Left + \"B-1\":both",
           "Left:both - \"B-1\":surface",
           "Brain - Left + A:surface",
           "Left + A(opacity=0.5)",
           "*",
           "*:both(opacity=0.5)",
           "* - Right",
           "A(profile=thin)",
           "A(opacity=0.5,color=#ff8800,profile=hard,low=-20.5,high=1e+20)",
           "A:both(opacity=0.5,curve=-20:0:0.25/1e-05:0.3/0.1:0:0)",
           "Left(curve=10:0.5) + A(profile=soft)",
           "Left(curve=10:0.5) + A(low=3)",
           "Left(low=10,high=20) + A(high=30)",
           "Left(profile=thin,low=10) + A(profile=hard)",
           "Left(low=10,high=20) + A(curve=10:0.5)",
           "Left(low=10) - A + A",
           "*(profile=hard) + A(profile=soft)",
           "Left:surface(ghost)",
           "Left:surface(ghost,opacity=0.25,color=#ff8800) + A:surface",
           "Brain:surface(ghost) + A:surface(color=#ff8800)",
           "*:surface(ghost) - Left + A:surface",
       }) {
    EXPECT_EQ(to_text(*Selection::parse(text, graph), graph), text);
  }
}

TEST(SelectionText, LeavesOutWhatChangesNothing) {
  const StructureGraph graph = brain();
  const std::vector<std::pair<const char*, const char*>> texts{
      {"A + A", "A"},
      {"\"Area A\"", "A"},
      {"Left + A + \"B-1\"", "Left"},
      {"A:volume + A:surface", "A:both"},
      {"Brain - Brain", ""},
      {"A(color=#010101)", "A"},
      {"A(profile=soft)", "A"},
      {"A(curve=1:0.5:1)", "A(curve=1:0.5)"},
      {"A(profile=thin,low=1) + A(curve=1:0.5)", "A(curve=1:0.5)"},
      {"A(curve=1:0.5) + A(PROFILE=Thin)", "A(profile=thin)"},
      {"A(low=1,high=5) + A(low=5)", "A(low=5)"},
      {"A(low=1,high=5) + A(high=1)", "A(high=1)"},
      {"A(low=1,high=5) + A(low=6,high=7)", "A(low=6,high=7)"},
      {"Lobe + Brain", "*"},
      {"Left(color=#f00) - A + A", "Left(color=#ff0000) + A(color=#010101)"},
      {"Brain(color=#ff0000) - Left + Left", "Brain + Right(color=#ff0000)"},
      {"Brain(color=#123456) - Left + Left", "Brain(color=#123456) - Left + Left"},
  };
  for (const auto& [text, shorter] : texts) {
    const auto selection = Selection::parse(text, graph);
    ASSERT_TRUE(selection) << text;
    EXPECT_EQ(to_text(*selection, graph), shorter) << text;
  }
}

TEST(SelectionText, QuotesAStructureCalledRest) {
  const StructureGraph graph = *StructureGraph::build({{.id = "Rest"}, {.id = "A", .label = 17}});
  for (const auto& [text, written] : {std::pair{"\"rest\":surface", "\"Rest\":surface"},
                                      {"#17(opacity=0.5)", "A(opacity=0.5)"},
                                      {"A:surface + rest", "* - A + A:surface"},
                                      {"rest", "*"}}) {
    const auto selection = Selection::parse(text, graph);
    ASSERT_TRUE(selection) << text;
    const std::string again = to_text(*selection, graph);
    EXPECT_TRUE(again == written || again == "A:surface + \"Rest\"" || again == "\"Rest\" + A:surface")
        << again;
    EXPECT_EQ(without_term_numbers(*Selection::parse(again, graph)), without_term_numbers(*selection));
  }
}

TEST(SelectionText, OpacitiesComeBackToTheBit) {
  const StructureGraph graph = brain();
  for (const float opacity : {0.1f, 1.0f / 3, 1e-7f, 1e-38f, 0.99999994f, 1.0f}) {
    Selection selection;
    selection.structures.resize(graph.size());
    selection.structures[3] = {DrawMode::kVolume, opacity, graph[3].color, 0};
    EXPECT_EQ(Selection::parse(to_text(selection, graph), graph)->structures[3].opacity, opacity);
  }
}

RC_GTEST_PROP(SelectionText, SelectsExactlyWhatWasWritten, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const Selection wanted = random_selection(graph, random);
  const std::string text = to_text(wanted, graph);
  const auto selected = Selection::parse(text, graph);
  if (!selected) RC_FAIL(selected.error().message);
  RC_LOG() << text;
  RC_ASSERT(without_term_numbers(*selected) == wanted);
}

RC_GTEST_PROP(SelectionText, IsStable, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const std::string text = to_text(random_selection(graph, random), graph);
  RC_ASSERT(to_text(*Selection::parse(text, graph), graph) == text);
}

}  // namespace
}  // namespace splatlas
