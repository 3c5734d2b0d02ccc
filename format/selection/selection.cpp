#include "format/content/selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <unordered_map>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/selection/selection_terms.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// First fault of an appearance; "" for none.
std::string fault_of(const VolumeStyle& style) {
  if (style.profile > TransferProfile::kHard) {
    return fmt::format("profile {} must be soft, thin or hard", static_cast<int>(style.profile));
  }
  if (style.low && !std::isfinite(*style.low)) return fmt::format("low {} must be finite", *style.low);
  if (style.high && !std::isfinite(*style.high)) return fmt::format("high {} must be finite", *style.high);
  if (style.low && style.high && !(*style.low < *style.high)) {
    return fmt::format("low {} must be below high {}", *style.low, *style.high);
  }
  if (!style.curve) return "";
  if (style.low || style.high || style.profile != TransferProfile::kSoft) {
    return "a curve replaces profile, low and high; reset them";
  }
  const Result<void> checked = check_curve(*style.curve);
  return checked ? "" : checked.error().message;
}

std::string fault_of(const StructureDraw& draw) {
  if (draw.mode > DrawMode::kBoth) {
    return fmt::format("mode {} must be off, volume, surface or both", static_cast<int>(draw.mode));
  }
  if (draw.mode == DrawMode::kOff) return "";
  if (draw.opacity && !(*draw.opacity >= 0 && *draw.opacity <= 1)) {
    return fmt::format("opacity {} must be from 0 to 1", *draw.opacity);
  }
  return fault_of(draw.volume);
}

/// Draw modes are bit sets of parts.
static_assert(static_cast<unsigned>(DrawMode::kBoth) ==
              (static_cast<unsigned>(DrawMode::kVolume) | static_cast<unsigned>(DrawMode::kSurface)));

unsigned parts_of(DrawMode mode) {
  return static_cast<unsigned>(mode);
}

void remove(DrawMode mode, StructureDraw& draw) {
  const unsigned parts = mode == DrawMode::kOff ? parts_of(DrawMode::kBoth) : parts_of(mode);
  draw.mode = static_cast<DrawMode>(parts_of(draw.mode) & ~parts);
  if (draw.mode == DrawMode::kOff) draw = {};
}

void restyle(const SelectionTerm& term, VolumeStyle& style) {
  if (term.curve) {
    style = {};
    style.curve = term.curve;
    return;
  }
  if (term.profile || term.low || term.high) style.curve.reset();
  if (term.profile) style.profile = *term.profile;
  if (term.low) style.low = term.low;
  if (term.high) style.high = term.high;
  if (style.low && style.high && !(*style.low < *style.high)) (term.low ? style.high : style.low).reset();
}

void add(const SelectionTerm& term, std::uint32_t number, Rgb own_color, StructureDraw& draw) {
  if (draw.mode == DrawMode::kOff) draw.color = own_color;
  const DrawMode mode = term.mode == DrawMode::kOff ? DrawMode::kVolume : term.mode;
  draw.mode = static_cast<DrawMode>(parts_of(draw.mode) | parts_of(mode));
  if (term.ghost != draw.ghost) draw.opacity.reset();
  if (term.ghost || draw.ghost) draw.color = term.ghost ? kGhostColor : own_color;
  draw.ghost = term.ghost;
  if (term.opacity) draw.opacity = term.opacity;
  if (term.color) draw.color = *term.color;
  restyle(term, draw.volume);
  draw.term = number;
}

/// Finds the targets of many terms: without an index, each would take a pass over all structures.
class TargetFinder {
 public:
  TargetFinder(const StructureGraph& graph, std::size_t terms) : graph_(graph) {
    constexpr std::size_t kFewTerms = 32;  // cost less than the index
    if (terms < kFewTerms) return;
    for (StructureIndex s = 0; s < graph.size(); ++s) {
      const Structure& structure = graph[s];
      index_.emplace("id " + to_lower(structure.id), s);
      index_.emplace("name " + to_lower(structure.name), s);
      for (const Term& term : structure.terms) index_.emplace("term " + to_lower(term.value), s);
      if (structure.label) index_.emplace(fmt::format("label {}", *structure.label), s);
    }
  }

  [[nodiscard]] Result<std::vector<StructureIndex>> find(const SelectionTerm& term) const {
    const bool is_pattern = term.name.find('*') != std::string::npos;
    if (index_.empty() || is_pattern || term.target == TermTarget::kRest) return find_target(graph_, term);
    const std::string name = to_lower(term.name);
    std::vector<std::string> keys{"id " + name, "name " + name};
    if (name.find('/') == std::string::npos) keys.push_back("term " + name);  // paths take precedence
    if (term.target == TermTarget::kLabel) keys = {fmt::format("label {}", term.label)};
    for (const std::string& key : keys) {
      const auto [first, end] = index_.equal_range(key);
      if (first == end) continue;
      if (std::next(first) == end) return std::vector{first->second};
      break;
    }
    return find_target(graph_, term);  // a path, an ambiguous term, or an error
  }

 private:
  const StructureGraph& graph_;
  std::unordered_multimap<std::string, StructureIndex> index_;  // keys in lower case
};

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

/// Numbers of the terms in the order of application, which StructureDraw::term indexes: for the rest first.
std::vector<std::size_t> application_order(std::span<const SelectionTerm> terms) {
  std::vector<std::size_t> order(terms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(),
                        [&](std::size_t n) { return terms[n].target == TermTarget::kRest; });
  return order;
}

}  // namespace

Result<void> check_selection(const Selection& selection, const StructureGraph& graph) {
  if (selection.structures.size() > graph.size()) {
    return fail(ErrorCode::kUsage, "selection: {} structures, but the atlas has {}; make it for this atlas",
                selection.structures.size(), graph.size());
  }
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    const std::string fault = fault_of(selection.structures[s]);
    if (fault.empty()) continue;
    return fail(ErrorCode::kUsage, "selection: structure {} ({}): {}", s, in_quotes(graph[s].id), fault);
  }
  return {};
}

const char* name_of(DrawMode mode) {
  constexpr std::array kNames{"off", "volume", "surface", "both"};
  return kNames.at(static_cast<std::size_t>(mode));
}

const char* name_of(TransferProfile profile) {
  constexpr std::array kNames{"soft", "thin", "hard"};
  return kNames.at(static_cast<std::size_t>(profile));
}

bool operator==(const VolumeStyle& a, const VolumeStyle& b) {
  const bool same_curve = a.curve == b.curve || (a.curve && b.curve && *a.curve == *b.curve);
  return same_curve && a.profile == b.profile && a.low == b.low && a.high == b.high;
}

bool Selection::empty() const {
  return std::all_of(structures.begin(), structures.end(),
                     [](const StructureDraw& draw) { return draw.mode == DrawMode::kOff; });
}

Result<std::vector<StructureIndex>> find_target(const StructureGraph& graph, const SelectionTerm& term) {
  if (term.target == TermTarget::kRest) return std::vector<StructureIndex>();
  if (term.target == TermTarget::kName) {
    if (term.name == "*" && graph.size() == 0) return std::vector<StructureIndex>();
    return graph.find(term.name);
  }
  SPLATLAS_ASSIGN_OR_RETURN(const StructureIndex labelled, graph.find_label(term.label));
  return std::vector{labelled};
}

/// "; write "Left-Hippocampus" in quotes" if removals from a term on spell a structure's name; else "".
std::string remedy_for(const SelectionTerm& term, std::span<const SelectionTerm> terms,
                       const StructureGraph& graph) {
  auto n = static_cast<std::size_t>(&term - terms.data());
  while (n > 0 && terms[n].remove) --n;
  std::string name = terms[n].name, remedy;
  while (++n < terms.size() && terms[n].remove) {
    name += "-" + terms[n].name;
    if (name.find('*') == std::string::npos && graph.find(name))
      remedy = fmt::format("; write {} in quotes", in_quotes(name));
  }
  return remedy;
}

Result<Selection> resolve_selection(std::span<const SelectionTerm> terms, const StructureGraph& graph,
                                    std::span<const Rgb> colors) {
  const TargetFinder targets(graph, terms.size());
  const auto structures_of = [&](const SelectionTerm& term) -> Result<std::vector<StructureIndex>> {
    check_task();
    const auto found = targets.find(term);
    if (found) return graph.descendants(*found);
    return fail(found.error().code, "selection, column {}: {}{}", term.column + 1, found.error().message,
                remedy_for(term, terms, graph));
  };
  const std::vector<std::size_t> order = application_order(terms);

  // Find the rest, if it is needed: what no term names
  std::vector<StructureIndex> rest;
  if (!order.empty() && terms[order.front()].target == TermTarget::kRest) {
    std::vector<bool> named(graph.size());
    for (const SelectionTerm& term : terms) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> structures, structures_of(term));
      for (const StructureIndex s : structures) named[s] = true;
    }
    for (StructureIndex s = 0; s < graph.size(); ++s) {
      if (!named[s]) rest.push_back(s);
    }
  }

  Selection selection;
  selection.structures.resize(graph.size());
  for (std::uint32_t number = 0; number < order.size(); ++number) {
    const SelectionTerm& term = terms[order[number]];
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> structures,
                              term.target == TermTarget::kRest ? rest : structures_of(term));
    for (const StructureIndex s : structures) {
      if (term.remove) {
        remove(term.mode, selection.structures[s]);
      } else {
        add(term, number, colors.empty() ? graph[s].color : colors[s], selection.structures[s]);
      }
    }
  }
  return selection;
}

Result<Selection> Selection::parse(std::string_view text, const StructureGraph& graph) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SelectionTerm> terms, parse_selection(text));
  return resolve_selection(terms, graph);
}

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
