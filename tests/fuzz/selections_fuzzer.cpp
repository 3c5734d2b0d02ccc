// Fuzz target: selection text, on a graph with difficult names.
// Input: the text.
#include <string>

#include "format/selection.h"
#include "format/transfer_curve.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

/// Several parents, repeated names, and names that need quotes.
StructureGraph make_graph() {
  std::vector<Structure> structures(9);
  const std::array<const char*, 9> ids{"Brain", "Left", "Right", "G1", "g-2", "g.3", "Lobe", "x", "Needle"};
  const std::array<const char*, 9> names{"Brain",      "Left side",  "Right side", "Gyrus",    "Gyrus",
                                         "Kern \"a\"", "white/grey", "*",          "Größe + 1"};
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
  return require_value(StructureGraph::build(std::move(structures)));
}

/// Requires that positions ("column 12: ...") lie within the text or right behind it.
void check_terms(const std::vector<SelectionTerm>& terms, std::string_view text) {
  for (const SelectionTerm& term : terms) {
    require(term.column < text.size(), "a term begins behind the text");
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

}  // namespace

void fuzz(FuzzInput input) {
  static const StructureGraph graph = make_graph();
  const std::string_view text = input.rest_as_text();
  const auto terms = parse_selection(text);
  if (!terms) return require_error(terms.error(), {ErrorCode::kUsage});
  check_terms(*terms, text);
  const auto selection = resolve_selection(*terms, graph);
  if (!selection) return require_error(selection.error(), {ErrorCode::kNotFound, ErrorCode::kUsage});
  const std::string again = to_text(*selection, graph);
  require(have_same_appearance(require_value(select(again, graph)), *selection),
          "a selection's text selects another one");
}

}  // namespace splatlas
