// Formatter of selection text.
#include <algorithm>

#include <fmt/format.h>

#include "format/selection.h"
#include "format/selection/selection_options.h"
#include "format/selection/selection_terms.h"

namespace splatlas {
namespace {

std::string text_of(const SelectionTerm& term) {
  const bool plain = std::all_of(term.name.begin(), term.name.end(), is_name_character);
  std::string text = plain ? term.name : '"' + term.name + '"';  // ids and "*" contain no quotes
  const bool is_default_mode = term.mode == (term.remove ? DrawMode::kOff : DrawMode::kVolume);
  if (!is_default_mode) text += fmt::format(":{}", name_of(term.mode));
  std::vector<std::string> options;
  for (const SelectionOption& option : selection_options()) {
    if (option.is_given(term)) options.push_back(fmt::format("{}={}", option.name, option.write(term)));
  }
  if (!options.empty()) text += fmt::format("({})", fmt::join(options, ","));
  return text;
}

bool have_same_appearance(const StructureDraw& a, const StructureDraw& b) {
  if (a.mode == DrawMode::kOff && b.mode == DrawMode::kOff) return true;
  return a.mode == b.mode && a.opacity == b.opacity && a.color == b.color && a.volume == b.volume;
}

/// The ramp on which a term's ramp options act. A ramp option replaces a curve by the default ramp.
VolumeStyle ramp_of(const VolumeStyle& style) {
  return style.curve ? VolumeStyle{} : style;
}

/// Sets the options of `term` that turn one style into another, unless cannot_restyle().
void restyle(const VolumeStyle& reached, const VolumeStyle& wanted, SelectionTerm& term) {
  if (reached == wanted) return;
  if (wanted.curve) {
    term.curve = wanted.curve;
    return;
  }
  const VolumeStyle ramp = ramp_of(reached);
  if (wanted.low != ramp.low) term.low = wanted.low;
  if (wanted.high != ramp.high) term.high = wanted.high;
  if (wanted.profile != ramp.profile || wanted == ramp) term.profile = wanted.profile;
}

/// True if no term can make the change: terms cannot reset an end of a ramp.
bool cannot_restyle(const VolumeStyle& reached, const VolumeStyle& wanted) {
  const VolumeStyle ramp = ramp_of(reached);
  return !wanted.curve && ((ramp.low && !wanted.low) || (ramp.high && !wanted.high));
}

/// Finds terms that turn an empty selection into the wanted one. Visits structures in topological order. A
/// term affects only descendants, so that it never changes a finished structure.
class TermFinder {
 public:
  TermFinder(const Selection& wanted, const StructureGraph& graph) : wanted_(wanted), graph_(graph) {
    reached_.structures.resize(graph.size());
  }

  /// Starts with a term that selects all structures with the appearance of `draw`.
  void begin_with_all(const StructureDraw& draw) {
    SelectionTerm term{.name = "*", .mode = draw.mode, .opacity = draw.opacity};
    restyle({}, draw.volume, term);
    add_term(std::move(term), graph_.topological());
  }

  std::vector<SelectionTerm> find() {
    for (const StructureIndex s : graph_.topological()) update(s);
    return std::move(terms_);
  }

 private:
  void update(StructureIndex s) {
    const StructureDraw& wanted = wanted_.structures[s];
    const StructureDraw& reached = reached_.structures[s];
    if (have_same_appearance(wanted, reached)) return;
    if (wanted.mode == DrawMode::kOff || must_remove_first(s)) remove(s, DrawMode::kOff);
    if (reached.mode == DrawMode::kBoth && wanted.mode == DrawMode::kVolume) remove(s, DrawMode::kSurface);
    if (reached.mode == DrawMode::kBoth && wanted.mode == DrawMode::kSurface) remove(s, DrawMode::kVolume);
    if (!have_same_appearance(wanted, reached)) add(s);
  }

  /// True if a removal must precede the new term: terms cannot reset an opacity, an end of a ramp or the
  /// colors of a subtree, nor replace volume by surface.
  [[nodiscard]] bool must_remove_first(StructureIndex s) const {
    const StructureDraw& wanted = wanted_.structures[s];
    const StructureDraw& reached = reached_.structures[s];
    if (reached.mode == DrawMode::kOff) return false;
    const bool swaps_parts =
        reached.mode != wanted.mode && reached.mode != DrawMode::kBoth && wanted.mode != DrawMode::kBoth;
    const bool own_color_again = wanted.color != reached.color && wanted.color == graph_[s].color;
    return swaps_parts || (reached.opacity && !wanted.opacity) ||
           cannot_restyle(reached.volume, wanted.volume) || (own_color_again && !graph_.children(s).empty());
  }

  void remove(StructureIndex s, DrawMode mode) {
    add_term({.remove = true, .name = graph_[s].id, .mode = mode}, graph_.descendants(s));
  }

  void add(StructureIndex s) {
    const StructureDraw& wanted = wanted_.structures[s];
    const StructureDraw& reached = reached_.structures[s];
    const Rgb color = reached.mode == DrawMode::kOff ? graph_[s].color : reached.color;
    SelectionTerm term{.name = graph_[s].id, .mode = wanted.mode};
    if (wanted.opacity != reached.opacity) term.opacity = wanted.opacity;
    if (wanted.color != color) term.color = wanted.color;
    restyle(reached.volume, wanted.volume, term);
    add_term(std::move(term), graph_.descendants(s));
  }

  void add_term(SelectionTerm term, std::span<const StructureIndex> structures) {
    apply_term(term, static_cast<std::uint32_t>(terms_.size()), structures, graph_, reached_);
    terms_.push_back(std::move(term));
  }

  const Selection& wanted_;
  const StructureGraph& graph_;
  Selection reached_;
  std::vector<SelectionTerm> terms_;
};

}  // namespace

std::string to_text(const Selection& selection, const StructureGraph& graph) {
  std::vector<SelectionTerm> terms = TermFinder(selection, graph).find();

  // "All but a few" is shorter if most structures are selected.
  const auto is_on = [&](StructureIndex s) { return selection.structures[s].mode != DrawMode::kOff; };
  const auto root = std::find_if(graph.roots().begin(), graph.roots().end(), is_on);
  if (root != graph.roots().end()) {
    TermFinder finder(selection, graph);
    finder.begin_with_all(selection.structures[*root]);
    std::vector<SelectionTerm> all_but = finder.find();
    if (all_but.size() < terms.size()) terms = std::move(all_but);
  }

  std::string text;
  for (const SelectionTerm& term : terms) {
    if (!text.empty()) text += term.remove ? " - " : " + ";
    text += text_of(term);
  }
  return text;
}

}  // namespace splatlas
