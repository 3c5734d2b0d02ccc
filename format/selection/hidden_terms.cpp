// Terms that later terms hide.
#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/selection/selection_terms.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// For each term: a structure that it adds in vain, as it is selected in the same way without the term.
/// Nothing for many terms, each of which takes a pass.
Result<std::vector<std::optional<StructureIndex>>> find_vain(std::span<const SelectionTerm> terms,
                                                             const StructureGraph& graph,
                                                             const Selection& whole) {
  std::vector<std::optional<StructureIndex>> vain(terms.size());
  constexpr std::size_t kMaxTerms = 64;
  for (std::size_t n = 0; n < terms.size() && terms.size() <= kMaxTerms; ++n) {
    if (terms[n].remove || terms[n].target == TermTarget::kRest) continue;
    // A removal in front removes nothing, and keeps the structures of the term out of the rest
    std::vector<SelectionTerm> others{terms[n]};
    others[0].remove = true;
    std::ranges::copy(terms.first(n), std::back_inserter(others));
    std::ranges::copy(terms.subspan(n + 1), std::back_inserter(others));
    SPLATLAS_ASSIGN_OR_RETURN(Selection without, resolve_selection(others, graph));
    for (StructureIndex s = 0; s < graph.size(); ++s) without.structures[s].term = whole.structures[s].term;
    if (without != whole) continue;
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> found, find_target(graph, terms[n]));
    for (const StructureIndex s : graph.descendants(found)) {
      if (whole.structures[s].mode != DrawMode::kOff && !vain[n]) vain[n] = s;
    }
  }
  return vain;
}

}  // namespace

Result<std::vector<HiddenTerm>> find_hidden_terms(std::span<const SelectionTerm> terms,
                                                  const StructureGraph& graph) {
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, resolve_selection(terms, graph));
  SPLATLAS_ASSIGN_OR_RETURN(const auto vain, find_vain(terms, graph, selection));
  const std::vector<std::size_t> order = application_order(terms);
  std::vector<HiddenTerm> hidden;
  for (std::size_t term = 0; term < terms.size(); ++term) {
    if (!vain[term]) continue;
    const std::size_t by = order[selection.structures[*vain[term]].term];
    if (by == term) continue;  // a removal took what it added
    const std::string name = in_quotes(terms[term].name);
    hidden.push_back(
        {term, by,
         fmt::format("selection, column {}: {} has no effect: the later {} selects the same in the same "
                     "way; write {} after it, with a mode, opacity or color of its own",
                     terms[term].column + 1, name, in_quotes(terms[by].name), name)});
  }
  return hidden;
}

}  // namespace splatlas
