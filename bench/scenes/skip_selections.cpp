#include "bench/scenes/skip_selections.h"

#include <random>

#include <fmt/format.h>

namespace splatlas {

std::vector<NamedSelection> many_selections(const StructureGraph& graph, const StructureDraw& draw,
                                            std::size_t unions) {
  std::vector<NamedSelection> selections;
  const auto nothing = [&] {
    Selection selection;
    selection.structures.resize(graph.size());
    return selection;
  };
  std::vector<StructureIndex> leaves;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (graph.children(s).empty()) leaves.push_back(s);
    Selection selection = nothing();
    for (const StructureIndex below : graph.descendants(s)) selection.structures[below] = draw;
    selections.push_back({graph[s].name.empty() ? graph[s].id : graph[s].name, std::move(selection)});
  }
  std::mt19937 random(1);
  for (std::size_t n = 0; n < unions; ++n) {
    std::size_t count = 2;
    for (std::size_t doubled = 0; doubled < n % 6 && 2 * count <= leaves.size(); ++doubled) count *= 2;
    Selection selection = nothing();
    for (std::size_t leaf = 0; leaf < count; ++leaf)
      selection.structures[leaves[random() % leaves.size()]] = draw;
    selections.push_back({fmt::format("up to {} random, {}", count, n), std::move(selection)});
  }
  return selections;
}

}  // namespace splatlas
