// Terms that later terms hide.
#include <algorithm>
#include <array>
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

/// The latest term to set each property of a structure, also to its default.
struct Owners {
  enum : std::size_t {
    kVolumePart,
    kSurfacePart,
    kGhost,
    kOpacity,
    kColor,
    kProfile,
    kLow,
    kHigh,
    kCurve,
    kCount
  };
  std::array<std::uint32_t, kCount> of;

  Owners() { of.fill(kNobody); }

  /// Follows the term `number`, which has changed `before` to `after`. Calls lasts(term) for terms on which
  /// the result depends, although they may own nothing in the end.
  template <typename Lasts>
  void follow(const SelectionTerm& term, std::uint32_t number, const StructureDraw& before,
              const StructureDraw& after, const Lasts& lasts) {
    if (term.remove) return follow_removal(before, after, lasts);
    const auto take = [&](std::size_t property, bool set) {
      if (set) of[property] = number;
    };
    take(kVolumePart, term.mode != DrawMode::kSurface);
    take(kSurfacePart, term.mode == DrawMode::kSurface || term.mode == DrawMode::kBoth);
    // Begin and end of a ghost reset the appearance, depending on the term before
    const bool resets = before.ghost != after.ghost;
    if (resets) lasts(of[kGhost]);
    take(kGhost, before.ghost || after.ghost);
    take(kOpacity, resets || term.opacity);
    take(kColor, resets || term.ghost || term.color);
    // A new end of a ramp resets the other end, depending on both terms
    const auto is_reset = [&](const std::optional<double> VolumeStyle::*end) {
      return !term.curve && before.volume.*end && !(after.volume.*end);
    };
    if (is_reset(&VolumeStyle::low)) lasts(of[kLow]);
    if (is_reset(&VolumeStyle::high)) lasts(of[kHigh]);
    if (is_reset(&VolumeStyle::low) || is_reset(&VolumeStyle::high)) lasts(number);
    take(kProfile, term.curve || term.profile);
    take(kLow, term.curve || term.low);
    take(kHigh, term.curve || term.high);
    take(kCurve, term.curve || before.volume.curve != after.volume.curve);
  }

 private:
  /// A part that remains keeps the options of the structure.
  template <typename Lasts>
  void follow_removal(const StructureDraw& before, const StructureDraw& after, const Lasts& lasts) {
    if (after.mode == before.mode) return;
    if (after.mode == DrawMode::kOff) {
      *this = Owners();
      return;
    }
    const bool is_volume = after.mode == DrawMode::kVolume;
    lasts(of[is_volume ? kVolumePart : kSurfacePart]);
    of[is_volume ? kSurfacePart : kVolumePart] = kNobody;
  }
};

/// A selection, and the terms without effect on it.
struct ReviewedSelection {
  Selection selection;
  /// For each term, by number: a structure that it adds in vain, as it is selected anyway.
  std::vector<std::optional<StructureIndex>> in_vain;
};

Result<ReviewedSelection> review(std::span<const SelectionTerm> terms, const StructureGraph& graph) {
  ReviewedSelection of;
  of.selection.structures.resize(graph.size());
  std::vector<Owners> owners(graph.size());
  std::vector<bool> lasts(terms.size());
  const auto mark = [&](std::uint32_t term) {
    if (term != kNobody) lasts[term] = true;
  };
  SPLATLAS_RETURN_IF_ERROR(for_each_term(
      terms, graph,
      [&](const SelectionTerm& term, std::uint32_t number, std::span<const StructureIndex> structures) {
        for (const StructureIndex s : structures) {
          const StructureDraw before = of.selection.structures[s];
          apply_term(term, number, {&s, 1}, graph, of.selection);
          owners[s].follow(term, number, before, of.selection.structures[s], mark);
        }
      }));
  for (const Owners& owner : owners) std::ranges::for_each(owner.of, mark);

  of.in_vain.resize(terms.size());
  SPLATLAS_RETURN_IF_ERROR(for_each_term(
      terms, graph,
      [&](const SelectionTerm& term, std::uint32_t number, std::span<const StructureIndex> structures) {
        if (term.remove || lasts[number]) return;
        const auto on = std::ranges::find_if(
            structures, [&](StructureIndex s) { return of.selection.structures[s].mode != DrawMode::kOff; });
        if (on != structures.end()) of.in_vain[number] = *on;
      }));
  return of;
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
  SPLATLAS_ASSIGN_OR_RETURN(const ReviewedSelection of, review(terms, graph));
  const std::vector<std::uint32_t> covers = find_covers(of.selection, terms.size(), tree);
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
    if (const auto s = of.in_vain[number]) {
      const std::uint32_t by = of.selection.structures[*s].term;
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
