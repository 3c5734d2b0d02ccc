// Formatter of selection text.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/selection/selection_terms.h"

namespace splatlas {
namespace {

std::string text_of(const SelectionTerm& term) {
  const bool plain =
      std::all_of(term.name.begin(), term.name.end(), is_name_character) && !is_rest(term.name);
  std::string text = plain ? term.name : '"' + term.name + '"';  // ids and "*" contain no quotes
  const bool is_default_mode = !term.ghost && term.mode == (term.remove ? DrawMode::kOff : DrawMode::kVolume);
  if (!is_default_mode) text += fmt::format(":{}", name_of(term.mode));
  const std::string options = write_options(term);
  return options.empty() ? text : fmt::format("{}({})", text, options);
}

bool have_same_appearance(const StructureDraw& a, const StructureDraw& b) {
  if (a.mode == DrawMode::kOff && b.mode == DrawMode::kOff) return true;
  return a.mode == b.mode && a.opacity == b.opacity && a.color == b.color && a.volume == b.volume &&
         a.ghost == b.ghost;
}

/// The ramp on which a term's ramp options act. A ramp option replaces a curve by the default ramp.
VolumeStyle ramp_of(const VolumeStyle& style) {
  return style.curve ? VolumeStyle{} : style;
}

/// Sets the options of `term` that turn one style into another, unless cannot_restyle().
void restyle(const VolumeStyle& current, const VolumeStyle& target, SelectionTerm& term) {
  if (current == target) return;
  if (target.curve) {
    term.curve = target.curve;
    return;
  }
  const VolumeStyle ramp = ramp_of(current);
  if (target.low != ramp.low) term.low = target.low;
  if (target.high != ramp.high) term.high = target.high;
  if (target.profile != ramp.profile || target == ramp) term.profile = target.profile;
}

/// True if no term can make the change: terms cannot reset an end of a ramp.
bool cannot_restyle(const VolumeStyle& current, const VolumeStyle& target) {
  const VolumeStyle ramp = ramp_of(current);
  return !target.curve && ((ramp.low && !target.low) || (ramp.high && !target.high));
}

/// Finds terms that turn an empty selection into the target one. Visits structures in topological order. A
/// term affects only descendants, so that it never changes a finished structure.
class TermFinder {
 public:
  TermFinder(const Selection& target, const StructureGraph& graph) : target_(target), graph_(graph) {
    current_.structures.resize(graph.size());
  }

  /// Starts with a term that selects all structures with the appearance of `draw`.
  void begin_with_all(const StructureDraw& draw) {
    SelectionTerm term{.name = "*", .mode = draw.mode, .ghost = draw.ghost, .opacity = draw.opacity};
    if (draw.ghost && draw.color != kGhostColor) term.color = draw.color;
    restyle({}, draw.volume, term);
    add_term(std::move(term), graph_.topological());
  }

  std::vector<SelectionTerm> find() {
    for (const StructureIndex s : graph_.topological()) update(s);
    return std::move(terms_);
  }

 private:
  void update(StructureIndex s) {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    if (have_same_appearance(target, current)) return;
    if (target.mode == DrawMode::kOff || must_remove_first(s)) remove(s, DrawMode::kOff);
    if (current.mode == DrawMode::kBoth && target.mode == DrawMode::kVolume) remove(s, DrawMode::kSurface);
    if (current.mode == DrawMode::kBoth && target.mode == DrawMode::kSurface) remove(s, DrawMode::kVolume);
    if (!have_same_appearance(target, current)) add(s);
  }

  /// True if a removal must precede the new term: terms cannot reset an opacity, an end of a ramp or the
  /// colors of a subtree, nor replace volume by surface.
  [[nodiscard]] bool must_remove_first(StructureIndex s) const {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    if (current.mode == DrawMode::kOff) return false;
    const bool resets = target.ghost != current.ghost;
    const bool swaps_parts =
        current.mode != target.mode && current.mode != DrawMode::kBoth && target.mode != DrawMode::kBoth;
    const bool own_color_again = target.color != current.color && target.color == graph_[s].color;
    return swaps_parts || (current.opacity && !target.opacity && !resets) ||
           cannot_restyle(current.volume, target.volume) ||
           (own_color_again && !resets && !graph_.children(s).empty());
  }

  void remove(StructureIndex s, DrawMode mode) {
    add_term({.remove = true, .name = graph_[s].id, .mode = mode}, graph_.descendants(s));
  }

  void add(StructureIndex s) {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    const bool resets = current.mode == DrawMode::kOff || target.ghost != current.ghost;
    const Rgb color = target.ghost ? kGhostColor : resets ? graph_[s].color : current.color;
    SelectionTerm term{.name = graph_[s].id, .mode = target.mode, .ghost = target.ghost};
    if (resets || target.opacity != current.opacity) term.opacity = target.opacity;
    if (target.color != color) term.color = target.color;
    restyle(current.volume, target.volume, term);
    add_term(std::move(term), graph_.descendants(s));
  }

  void add_term(SelectionTerm term, std::span<const StructureIndex> structures) {
    apply_term(term, static_cast<std::uint32_t>(terms_.size()), structures, graph_, current_);
    terms_.push_back(std::move(term));
  }

  const Selection& target_;
  const StructureGraph& graph_;
  Selection current_;
  std::vector<SelectionTerm> terms_;
};

}  // namespace

std::string to_text(const Selection& selection, const StructureGraph& graph) {
  std::vector<SelectionTerm> terms = TermFinder(selection, graph).find();

  // "All but a few" is shorter if most structures are selected. It makes one hull of all ghosts.
  const auto cost = [](const std::vector<SelectionTerm>& of) {
    return std::pair(std::ranges::count(of, true, &SelectionTerm::ghost), of.size());
  };
  const auto try_all_but = [&](const StructureDraw& draw) {
    TermFinder finder(selection, graph);
    finder.begin_with_all(draw);
    std::vector<SelectionTerm> all_but = finder.find();
    if (cost(all_but) < cost(terms)) terms = std::move(all_but);
  };
  const auto is_on = [&](StructureIndex s) { return selection.structures[s].mode != DrawMode::kOff; };
  const auto root = std::find_if(graph.roots().begin(), graph.roots().end(), is_on);
  if (root != graph.roots().end()) try_all_but(selection.structures[*root]);
  const auto is_ghost = [](const StructureDraw& draw) { return draw.mode != DrawMode::kOff && draw.ghost; };
  const auto ghost = std::ranges::find_if(selection.structures, is_ghost);
  if (ghost != selection.structures.end()) try_all_but(*ghost);

  std::string text;
  for (const SelectionTerm& term : terms) {
    if (!text.empty()) text += term.remove ? " - " : " + ";
    text += text_of(term);
  }
  return text;
}

}  // namespace splatlas
