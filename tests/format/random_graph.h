// Small random structure graphs and selections for property tests.
#pragma once

#include <algorithm>
#include <memory>
#include <numeric>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/content/structure_graph.h"
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
    if (draw.ghost) out << " ghost";
    if (draw.opacity) out << " " << *draw.opacity;
    if (draw.mode == DrawMode::kOff) continue;
    out << " " << to_hex(draw.color) << " " << name_of(draw.volume.profile);
    if (draw.volume.low) out << " low " << *draw.volume.low;
    if (draw.volume.high) out << " high " << *draw.volume.high;
    if (draw.volume.curve) out << " curve of " << draw.volume.curve->points.size();
  }
}

/// A directed acyclic graph of `n` structures in any order. Names repeat; ids have "-" and capitals.
inline StructureGraph random_graph(std::size_t n, std::mt19937& random) {
  std::vector<StructureIndex> at(n);  // place in graph order -> index
  std::iota(at.begin(), at.end(), StructureIndex{0});
  std::shuffle(at.begin(), at.end(), random);
  const std::vector<std::string> names{"Left", "Right", "lobe", "Gyrus of A", "x", "white/grey", "Kern*"};
  std::vector<Structure> structures(n);
  for (std::size_t place = 0; place < n; ++place) {
    Structure& s = structures[at[place]];
    s.id = fmt::format("{}{}", below(2, random) == 0 ? "S-" : "s_", at[place]);
    s.name = below(2, random) == 0 ? names[below(names.size(), random)] : s.id + " name";
    s.color = default_color(below(4, random));
    s.external = below(5, random) == 0;
    for (auto terms = below(8, random); terms > 5; --terms) s.terms.push_back({names[terms - 1], s.name});
    const std::size_t parents = place == 0 ? 0 : std::min(place, below(4, random));
    while (s.parents.size() < parents) {
      const StructureIndex parent = at[below(place, random)];
      if (std::find(s.parents.begin(), s.parents.end(), parent) == s.parents.end())
        s.parents.push_back(parent);
    }
  }
  return *StructureGraph::build(std::move(structures));
}

/// A graph of 1 to 14 structures, for a property.
inline StructureGraph random_graph(std::mt19937& random) {
  return random_graph(*uniform<std::size_t>(1, 14), random);
}

/// Points of random bits or of plain numbers.
inline TransferCurve random_curve(std::mt19937& random) {
  const auto real = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  TransferCurve curve;
  double grey = random() % 2 == 0 ? real(-1e6, 100) : -50;
  for (std::size_t n = 1 + random() % 6; n > 0; --n) {
    curve.points.push_back({grey, random() % 2 == 0 ? static_cast<float>(real(0, 0.9999)) : 0.25f,
                            random() % 2 == 0 ? static_cast<float>(real(0, 1)) : 1.0f});
    grey += random() % 2 == 0 ? real(1e-6, 1e3) : 10;
  }
  return curve;
}

/// Few distinct styles, so that parent and child often share parts.
inline VolumeStyle random_style(std::mt19937& random) {
  VolumeStyle style;
  if (random() % 3 == 0) return style;
  if (random() % 4 == 0) {
    style.curve = std::make_shared<const TransferCurve>(
        random() % 2 == 0 ? random_curve(random) : TransferCurve{{{-10, 0, 0.5f}, {1e3, 0.5f}}});
    return style;
  }
  style.profile = static_cast<TransferProfile>(random() % 3);
  if (random() % 2 == 0) style.low = std::vector{-1e3, -0.1, 30.0}[random() % 3];
  if (random() % 2 == 0) style.high = std::vector{30.5, 1.0 / 3e-3, 1e9}[random() % 3];
  return style;
}

/// Gives a term a random style. Limits lie below and above one another, as no single term has them.
inline void set_random_style(SelectionTerm& term, std::mt19937& random) {
  const VolumeStyle style = random_style(random);
  term.curve = style.curve;
  if (style.profile != TransferProfile::kSoft) term.profile = style.profile;
  const double shift = random() % 2 == 0 ? 0 : -100;
  if (style.low) term.low = *style.low + shift;
  if (style.high) term.high = *style.high + shift;
}

/// Appearances often equal those of a parent, so that whole subtrees match.
inline Selection random_selection(const StructureGraph& graph, std::mt19937& random) {
  Selection selection;
  selection.structures.resize(graph.size());
  for (const StructureIndex s : graph.topological()) {
    StructureDraw& draw = selection.structures[s];
    const auto& parents = graph[s].parents;
    if (!parents.empty() && below(4, random) != 0) {
      const StructureIndex parent = parents[below(parents.size(), random)];
      draw = selection.structures[parent];
      if (draw.color == graph[parent].color) draw.color = graph[s].color;
      if (below(4, random) == 0) draw.volume = random_style(random);
    } else {
      draw.mode = std::vector{DrawMode::kOff, DrawMode::kVolume, DrawMode::kSurface,
                              DrawMode::kBoth}[below(4, random)];
      draw.color = below(3, random) == 0 ? default_color(below(4, random)) : graph[s].color;
      if (below(2, random) == 0) draw.opacity = std::vector{0.1f, 0.5f, 1.0f, 1e-6f}[below(4, random)];
      draw.volume = random_style(random);
      draw.ghost = below(4, random) == 0;
      if (draw.ghost && below(2, random) == 0) draw.color = kGhostColor;
    }
    if (draw.mode == DrawMode::kOff) draw = {};
  }
  return selection;
}

}  // namespace splatlas
