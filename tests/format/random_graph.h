// Small random structure graphs and selections for property tests.
#pragma once

#include <algorithm>
#include <numeric>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "format/selection.h"
#include "format/structure_graph.h"
#include "tests/format/random_volume.h"

namespace splatlas {

inline void showValue(const StructureGraph& graph, std::ostream& out) {
  for (const Structure& s : graph.structures()) {
    out << "\n"
        << s.id << " \"" << s.name << "\" " << to_hex(s.color) << (s.external ? " external" : "") << " in";
    for (const StructureIndex p : s.parents) out << " " << graph[p].id;
  }
}

inline void showValue(const Selection& selection, std::ostream& out) {
  for (const StructureDraw& draw : selection.structures) {
    out << " " << name_of(draw.mode);
    if (draw.opacity) out << " " << *draw.opacity;
    if (draw.mode != DrawMode::kOff) out << " " << to_hex(draw.color);
  }
}

/// A directed acyclic graph of `n` structures in no particular order: forests, trees and structures with
/// several parents; names repeat, ids hold "-" and capitals.
inline StructureGraph random_graph(std::size_t n, std::mt19937& random) {
  const auto below = [&random](std::size_t m) {
    return std::uniform_int_distribution<std::size_t>(0, m - 1)(random);
  };
  std::vector<StructureIndex> at(n);  // place in the graph's order -> index
  std::iota(at.begin(), at.end(), StructureIndex{0});
  std::shuffle(at.begin(), at.end(), random);
  const std::vector<std::string> names{"Left", "Right", "lobe", "Gyrus of A", "x", "white/grey", "Kern*"};
  std::vector<Structure> structures(n);
  for (std::size_t place = 0; place < n; ++place) {
    Structure& s = structures[at[place]];
    s.id = fmt::format("{}{}", below(2) == 0 ? "S-" : "s_", at[place]);
    s.name = below(2) == 0 ? names[below(names.size())] : s.id + " name";
    s.color = default_color(below(4));
    s.external = below(5) == 0;
    const std::size_t parents = place == 0 ? 0 : std::min(place, below(4));
    while (s.parents.size() < parents) {
      const StructureIndex parent = at[below(place)];
      if (std::find(s.parents.begin(), s.parents.end(), parent) == s.parents.end())
        s.parents.push_back(parent);
    }
  }
  return *StructureGraph::build(std::move(structures));
}

/// Looks that tend to be those of a parent, so that whole subtrees are alike.
inline Selection random_selection(const StructureGraph& graph, std::mt19937& random) {
  const auto below = [&random](std::size_t m) {
    return std::uniform_int_distribution<std::size_t>(0, m - 1)(random);
  };
  Selection selection;
  selection.structures.resize(graph.size());
  for (const StructureIndex s : graph.topological()) {
    StructureDraw& draw = selection.structures[s];
    const auto& parents = graph[s].parents;
    if (!parents.empty() && below(4) != 0) {
      const StructureIndex parent = parents[below(parents.size())];
      draw = selection.structures[parent];
      if (draw.color == graph[parent].color) draw.color = graph[s].color;
    } else {
      draw.mode =
          std::vector{DrawMode::kOff, DrawMode::kVolume, DrawMode::kSurface, DrawMode::kBoth}[below(4)];
      draw.color = below(3) == 0 ? default_color(below(4)) : graph[s].color;
      if (below(2) == 0) draw.opacity = std::vector{0.1f, 0.5f, 1.0f, 1e-6f}[below(4)];
    }
    if (draw.mode == DrawMode::kOff) draw = {};
  }
  return selection;
}

}  // namespace splatlas
