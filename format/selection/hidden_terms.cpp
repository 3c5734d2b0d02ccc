// Terms that later terms hide.
#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/selection/selection_terms.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

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

/// Structures whose volume is drawn in each class; kNoStructure for none.
std::map<ClassId, StructureIndex> owners_of_classes(const DrawPlan& plan) {
  std::map<ClassId, StructureIndex> owners;
  for (const ClassDraw& draw : plan.classes) owners[draw.id] = draw.volume_of;
  return owners;
}

/// For each term, by number: the term that holds all of its voxels, if there is one.
std::vector<std::uint32_t> find_covers(const Selection& selection, std::size_t terms,
                                       const DecisionTree& tree) {
  const DrawPlan plan = tree.plan(selection);
  const std::map<ClassId, StructureIndex> owners = owners_of_classes(plan);
  std::vector<bool> is_visible(terms);
  std::vector<std::uint32_t> covers(terms, kNobody);
  for (const StructureIndex s : plan.surfaces) is_visible[selection.structures[s].term] = true;
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    const std::uint32_t term = selection.structures[s].term;
    if (selection.structures[s].mode == DrawMode::kOff || is_visible[term]) continue;
    for (const auto classes : {tree.interior_classes(s), tree.boundary_classes(s)}) {
      for (const ClassId c : classes) {
        const auto owner = owners.find(c);
        if (owner == owners.end() || owner->second == kNoStructure) continue;
        const std::uint32_t other = selection.structures[owner->second].term;
        if (other == term) is_visible[term] = true;
        if (other != term && covers[term] == kNobody) covers[term] = other;
      }
    }
  }
  for (std::size_t term = 0; term < terms; ++term) {
    if (is_visible[term]) covers[term] = kNobody;
  }
  return covers;
}

}  // namespace

Result<std::vector<HiddenTerm>> find_hidden_terms(std::span<const SelectionTerm> terms,
                                                  const StructureGraph& graph, const DecisionTree& tree) {
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, resolve_selection(terms, graph));
  SPLATLAS_ASSIGN_OR_RETURN(const auto vain, find_vain(terms, graph, selection));
  const std::vector<std::uint32_t> covers = find_covers(selection, terms.size(), tree);
  const std::vector<std::size_t> order = application_order(terms);
  std::vector<HiddenTerm> hidden;
  for (std::uint32_t number = 0; number < order.size(); ++number) {
    const std::size_t term = order[number];
    const auto name = [&](std::size_t n) { return in_quotes(terms[n].name); };
    const auto report = [&](std::uint32_t by, const std::string& what) {
      hidden.push_back(
          {term, order[by],
           fmt::format("selection, column {}: {} {}", terms[term].column + 1, name(term), what)});
    };
    if (const auto s = vain[term]) {
      const std::uint32_t by = selection.structures[*s].term;
      if (by == number) continue;  // a removal took what it added
      report(by,
             fmt::format("has no effect: the later {} selects the same in the same way; write {} after it, "
                         "with a mode, opacity or color of its own",
                         name(order[by]), name(term)));
    } else if (covers[number] != kNobody) {
      report(covers[number],
             fmt::format("is hidden: all of its voxels are in {}, which takes precedence; write {} after it",
                         name(order[covers[number]]), name(term)));
    }
  }
  std::ranges::sort(hidden, {}, &HiddenTerm::term);
  return hidden;
}

}  // namespace splatlas
