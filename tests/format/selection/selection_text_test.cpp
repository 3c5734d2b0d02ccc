#include "tests/support/selection_text.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

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

TEST(SelectionText, OpacitiesComeBackToTheBit) {
  const StructureGraph graph = brain();
  for (const float opacity : {0.1f, 1.0f / 3, 1e-7f, 1e-38f, 0.99999994f, 1.0f}) {
    Selection selection;
    selection.structures.resize(graph.size());
    selection.structures[3] = {DrawMode::kVolume, opacity, graph[3].color, 0};
    EXPECT_EQ(Selection::parse(text_of(selection, graph), graph)->structures[3].opacity, opacity);
  }
}

RC_GTEST_PROP(SelectionText, SelectsExactlyWhatWasWritten, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const Selection wanted = random_selection(graph, random);
  const std::string text = text_of(wanted, graph);
  const auto selected = Selection::parse(text, graph);
  if (!selected) RC_FAIL(selected.error().message);
  RC_LOG() << text;
  RC_ASSERT(without_term_numbers(*selected) == wanted);
}

}  // namespace
}  // namespace splatlas
