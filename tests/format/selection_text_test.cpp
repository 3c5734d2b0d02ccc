#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/selection.h"
#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

Selection without_term_numbers(Selection selection) {
  for (StructureDraw& draw : selection.structures) draw.term = 0;
  return selection;
}

RC_GTEST_PROP(SelectionText, SelectsExactlyWhatWasWritten, ()) {
  const auto n = *uniform<std::size_t>(1, 14);
  auto random = *random_source();
  const StructureGraph graph = random_graph(n, random);
  const Selection wanted = random_selection(graph, random);
  const std::string text = to_text(wanted, graph);
  const auto selected = select(text, graph);
  if (!selected) RC_FAIL(selected.error().message);
  RC_LOG() << text;
  RC_ASSERT(without_term_numbers(*selected) == wanted);
}

RC_GTEST_PROP(SelectionText, IsStable, ()) {
  const auto n = *uniform<std::size_t>(1, 14);
  auto random = *random_source();
  const StructureGraph graph = random_graph(n, random);
  const std::string text = to_text(random_selection(graph, random), graph);
  RC_ASSERT(to_text(*select(text, graph), graph) == text);
}

}  // namespace
}  // namespace splatlas
