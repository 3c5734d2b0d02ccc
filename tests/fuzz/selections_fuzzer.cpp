// Fuzz target: selection text, on a graph with difficult names. Input: the text.
#include <array>
#include <string>

#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/content/transfer_curve.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/support/selection_text.h"

namespace splatlas {
namespace {

/// Several parents, repeated names, labels, and names that need quotes.
StructureGraph make_graph() {
  std::vector<Structure> structures(11);
  const std::array<const char*, 11> ids{"Brain", "Left", "Right",  "G1",   "g-2", "g.3",
                                        "Lobe",  "x",    "Needle", "rest", "17"};
  const std::array<const char*, 11> names{"Brain",     "Left side",  "Right side", "Gyrus",
                                          "Gyrus",     "Kern \"a\"", "white/grey", "*",
                                          "Größe + 1", "Rest",       "#17"};
  for (std::size_t n = 0; n < structures.size(); ++n) {
    structures[n].id = ids[n];
    structures[n].name = names[n];
    structures[n].color = default_color(n);
  }
  structures[1].parents = {0};
  structures[2].parents = {0};
  structures[3].parents = {1, 6};
  structures[4].parents = {2, 6};
  structures[5].parents = {1};
  structures[7].parents = {3, 4};
  structures[8].external = true;
  structures[3].label = 17;
  structures[4].label = -2;
  structures[5].label = structures[9].label = 5;
  return require_value(StructureGraph::build(std::move(structures)));
}

/// Voxels of most structures; those of the needle lie in others.
ClassTable make_classes() {
  ClassTable classes;
  for (const StructureIndex s : {3u, 4u, 5u, 7u, 9u}) {
    for (const Part part : {Part::kInterior, Part::kBoundary}) {
      classes.count(classes.intern({{s, part}}), 5, {{0, 0, 0}, {4, 0, 0}});
    }
    classes.count(classes.intern({{s, Part::kInterior}, {10, Part::kBoundary}}), 1, {{0, 0, 0}, {0, 0, 0}});
  }
  return classes;
}

/// Requires that positions ("column 12: ...") lie within the text or right behind it.
void check_terms(const std::vector<SelectionTerm>& terms, std::string_view text) {
  for (const SelectionTerm& term : terms) {
    require(term.column < text.size(), "a term begins behind the text");
    require(!term.remove || term.target != TermTarget::kRest, "a removal of the rest");
    require(!term.opacity || (*term.opacity > 0 && *term.opacity <= 1), "an opacity out of range");
    require(!term.curve || check_curve(*term.curve).has_value(), "an invalid curve");
    require(!term.low || !term.high || *term.low < *term.high, "a ramp without width");
  }
}

/// Equal up to the term numbers.
bool have_same_appearance(Selection a, const Selection& b) {
  for (std::size_t s = 0; s < a.structures.size(); ++s) a.structures[s].term = b.structures[s].term;
  return a == b;
}

void fuzz_selections(FuzzInput input) {
  static const StructureGraph graph = make_graph();
  static const ClassTable classes = make_classes();
  static const DecisionTree tree(graph, classes);
  const std::string_view text = input.rest_as_text();
  const auto terms = parse_selection(text);
  if (!terms) return require_error(terms.error(), {ErrorCode::kUsage});
  check_terms(*terms, text);
  const auto selection = resolve_selection(*terms, graph);
  if (!selection) return require_error(selection.error(), {ErrorCode::kNotFound, ErrorCode::kUsage});
  for (const HiddenTerm& hidden : require_value(find_hidden_terms(*terms, graph))) {
    require(hidden.term < terms->size() && hidden.hidden_by < terms->size(), "a hidden term out of range");
    require(hidden.term != hidden.hidden_by && !(*terms)[hidden.term].remove, "a hidden term that is none");
  }
  const std::string again = text_of(*selection, graph);
  require(have_same_appearance(require_value(Selection::parse(again, graph)), *selection),
          "a selection's text selects another one");
}

const FuzzTarget kSelections("selections", fuzz_selections);

}  // namespace
}  // namespace splatlas
