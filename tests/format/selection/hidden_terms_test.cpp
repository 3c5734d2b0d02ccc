#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/content/decision_tree.h"
#include "tests/format/random_graph.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// Cerebrum > (Hippocampus, Amygdala), and a lesion within the hippocampus: its voxels are in both.
struct Cerebrum {
  StructureGraph graph = *StructureGraph::build({{.id = "Cerebrum", .name = "Left cerebrum"},
                                                 {.id = "Hippocampus", .parents = {0}},
                                                 {.id = "Amygdala", .parents = {0}},
                                                 {.id = "Lesion", .label = 3},
                                                 {.id = "Nothing"}});
  ClassTable classes;
  DecisionTree tree;

  Cerebrum() : classes(make_classes()), tree(graph, classes) {}

  static ClassTable make_classes() {
    ClassTable classes;
    const std::vector<std::vector<Membership>> members{
        {{1, Part::kInterior}},
        {{1, Part::kBoundary}},
        {{2, Part::kInterior}},
        {{2, Part::kBoundary}},
        {{1, Part::kInterior}, {3, Part::kInterior}},
        {{1, Part::kInterior}, {3, Part::kBoundary}},
    };
    for (const auto& of : members) classes.count(classes.intern(of), 10, {{0, 0, 0}, {9, 9, 9}});
    return classes;
  }

  /// (term, hidden by) of each hidden term.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> hidden(std::string_view text) const {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    const auto found = find_hidden_terms(*parse_selection(text), graph);
    for (const HiddenTerm& of : *found) {
      pairs.emplace_back(of.term, of.hidden_by);
    }
    return pairs;
  }
  [[nodiscard]] std::string message(std::string_view text) const {
    const auto found = find_hidden_terms(*parse_selection(text), graph);
    return found->empty() ? "" : found->front().message;
  }
};

TEST(HiddenTerms, AGroupHidesItsMembers) {
  const Cerebrum brain;
  EXPECT_EQ(
      brain.message(" Hippocampus + \"Left cerebrum\""),
      "selection, column 2: \"Hippocampus\" has no effect: the later \"Left cerebrum\" selects the same in "
      "the same way; write \"Hippocampus\" after it, with a mode, opacity or color of its own");
  EXPECT_THAT(brain.hidden("Hippocampus + Amygdala + Cerebrum"),
              ElementsAre(std::pair(0, 2), std::pair(1, 2)));
  EXPECT_THAT(brain.hidden("Hippocampus:surface + Cerebrum:both"), ElementsAre(std::pair(0, 1)));
  EXPECT_THAT(brain.hidden("Hippocampus(opacity=0.5) + Cerebrum(opacity=0.1)"), ElementsAre(std::pair(0, 1)));
  EXPECT_THAT(brain.hidden("Hippocampus + Hippocampus"), ElementsAre(std::pair(0, 1)));
  EXPECT_THAT(brain.hidden("Hippocampus:surface(color=#ff0000) + Cerebrum(ghost)"),
              ElementsAre(std::pair(0, 1)));
  EXPECT_THAT(brain.hidden("#3 + Lesion:both"), ElementsAre(std::pair(0, 1)));
}

TEST(HiddenTerms, WhatLastsIsNotHidden) {
  const Cerebrum brain;
  for (const char* text :
       {"", "Hippocampus", "Hippocampus + Amygdala", "Cerebrum + Hippocampus",
        "Hippocampus:surface + Cerebrum", "Hippocampus(opacity=0.5) + Cerebrum",
        "Hippocampus(color=#ff0000) + Cerebrum(opacity=0.5)", "Hippocampus(low=3) + Cerebrum",
        "Hippocampus(curve=1:0.5) + Cerebrum(opacity=1)", "Hippocampus + rest:surface", "rest + Hippocampus",
        "Nothing", "Nothing + Cerebrum"}) {
    EXPECT_THAT(brain.hidden(text), IsEmpty()) << text;
  }
}

/// Removals are asked for.
TEST(HiddenTerms, RemovalsHideNothing) {
  const Cerebrum brain;
  for (const char* text :
       {"Hippocampus - Hippocampus", "Hippocampus - Cerebrum", "* - *", "Cerebrum:both - Hippocampus:surface",
        "Hippocampus - Cerebrum + Amygdala", "Hippocampus:surface + Hippocampus - Hippocampus:volume"}) {
    EXPECT_THAT(brain.hidden(text), IsEmpty()) << text;
  }
  EXPECT_THAT(brain.hidden("Hippocampus - Cerebrum + Cerebrum"), ElementsAre(std::pair(0, 2)));
}

TEST(HiddenTerms, UnknownNamesAreErrors) {
  const Cerebrum brain;
  EXPECT_THAT(find_hidden_terms(*parse_selection("Cerebrum + x"), brain.graph),
              FailsWith(ErrorCode::kNotFound, HasSubstr("column 12")));
}

/// A random term of the structures of a graph.
SelectionTerm random_term(const StructureGraph& graph, std::mt19937& random) {
  SelectionTerm term{.name = graph[static_cast<StructureIndex>(random() % graph.size())].id};
  if (random() % 8 == 0) {
    term.target = TermTarget::kRest;
  } else {
    term.remove = random() % 4 == 0;
  }
  term.mode = static_cast<DrawMode>(random() % 4);
  if (term.remove) return term;
  if (random() % 4 == 0) term.opacity = 0.25f * static_cast<float>(1 + random() % 4);
  if (random() % 4 == 0) term.color = default_color(random() % 4);
  term.ghost = random() % 4 == 0;
  if (random() % 3 != 0) return term;
  set_random_style(term, random);
  return term;
}

/// Without a term that has no effect, the selection is the same except for term numbers.
RC_GTEST_PROP(HiddenTerms, HaveNoEffect, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(1 + random() % 4, random);
  const ClassTable classes;
  const DecisionTree tree(graph, classes);
  std::vector<SelectionTerm> terms(random() % 9);
  for (SelectionTerm& term : terms) term = random_term(graph, random);
  const auto selected = [&] {
    Selection selection = *resolve_selection(terms, graph);
    for (StructureDraw& draw : selection.structures) draw.term = 0;
    return selection;
  };
  const Selection whole = selected();
  const auto found = find_hidden_terms(terms, graph);
  for (const HiddenTerm& hidden : *found) {
    RC_ASSERT(hidden.hidden_by > hidden.term);
    RC_ASSERT(!terms[hidden.term].remove);
    const std::vector<SelectionTerm> all = terms;
    const auto removed =
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(hidden.term)) - terms.begin();
    // A removal in front removes nothing, and keeps the structures of the term out of the rest
    const SelectionTerm& term = all[static_cast<std::size_t>(removed)];
    if (term.target == TermTarget::kName) terms.insert(terms.begin(), {.remove = true, .name = term.name});
    RC_ASSERT(selected() == whole);
    terms = all;
  }
}

}  // namespace
}  // namespace splatlas
