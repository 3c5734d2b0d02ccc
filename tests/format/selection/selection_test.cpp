#include "format/content/selection.h"

#include <stop_token>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/tasks/task_control.h"
#include "tests/format/random_graph.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

constexpr Rgb kRed{255, 0, 0};
constexpr Rgb kGreen{0, 255, 0};
constexpr Rgb kBlue{0, 0, 255};

/// Brain > (Left, Right) > A, B; B also below Lobe.
StructureGraph brain() {
  return *StructureGraph::build({
      {.id = "Brain", .name = "Brain", .color = kRed},                    // 0
      {.id = "Left", .name = "Left", .color = kRed, .parents = {0}},      // 1
      {.id = "Right", .name = "Right", .color = kGreen, .parents = {0}},  // 2
      {.id = "A", .name = "A", .color = kGreen, .parents = {1}},          // 3
      {.id = "B", .name = "B", .color = kBlue, .parents = {2, 5}},        // 4
      {.id = "Lobe", .name = "Lobe", .color = kBlue},                     // 5
  });
}

std::vector<StructureDraw> selected(std::string_view text) {
  const auto selection = Selection::parse(text, brain());
  if (!selection) {
    ADD_FAILURE() << selection.error().message;
    return std::vector<StructureDraw>(6);
  }
  return selection->structures;
}

StructureDraw draw(DrawMode mode, Rgb color, std::uint32_t term, std::optional<float> opacity = {}) {
  return {mode, opacity, color, term};
}

constexpr DrawMode kVolume = DrawMode::kVolume;
constexpr DrawMode kSurface = DrawMode::kSurface;
constexpr DrawMode kBoth = DrawMode::kBoth;
const StructureDraw kOff{};

TEST(Selection, NothingSelectsNothing) {
  const auto selection = value_or_throw(Selection::parse("", brain()));
  EXPECT_EQ(selection.structures, std::vector<StructureDraw>(6));
  EXPECT_TRUE(selection.empty());
  EXPECT_TRUE(Selection{}.empty());
  EXPECT_FALSE(Selection::parse("A", brain())->empty());
}

/// The rest is all that no other term names, before or behind it, as a removal, too.
TEST(Selection, TheRestIsWhatNoOtherTermNames) {
  const StructureDraw faint{kSurface, 0.1f, kRed, 0};
  auto rest = selected("A:both + rest:surface(opacity=0.1)");
  EXPECT_EQ(rest[0], faint);
  EXPECT_EQ(rest[3], draw(kBoth, kGreen, 1));  // numbered after the rest
  EXPECT_EQ(rest[4], draw(kSurface, kBlue, 0, 0.1f));
  EXPECT_EQ(rest, selected("rest:surface(opacity=0.1) + A:both"));
  EXPECT_EQ(rest[5], draw(kSurface, kBlue, 0, 0.1f));

  const auto removed = selected("A + rest - Lobe:surface");
  EXPECT_EQ(removed[0].mode, kVolume);
  EXPECT_EQ(removed[4], kOff);  // below Lobe
  EXPECT_EQ(removed[5], kOff);
  EXPECT_EQ(selected("rest"), selected("*"));
  EXPECT_EQ(selected("* + rest:surface")[3].mode, kVolume);
  const auto twice = selected("rest:surface + Left + rest(opacity=0.5)");
  EXPECT_EQ(twice[4], draw(kBoth, kBlue, 1, 0.5f));
  EXPECT_EQ(twice[3], draw(kVolume, kGreen, 2));
}

TEST(Selection, AStructureMayBeCalledRest) {
  const StructureGraph graph = *StructureGraph::build(
      {{.id = "rest", .name = "Rest"}, {.id = "h", .name = "#17"}, {.id = "o", .label = 17}});
  const auto is_on = [&](const char* text) {
    std::vector<bool> on;
    const Selection selection = *Selection::parse(text, graph);
    for (const StructureDraw& draw : selection.structures) on.push_back(draw.mode != DrawMode::kOff);
    return on;
  };
  EXPECT_EQ(is_on("\"rest\""), (std::vector{true, false, false}));
  EXPECT_EQ(is_on("h + rest"), (std::vector{true, true, true}));
  EXPECT_EQ(is_on("\"#17\""), (std::vector{false, true, false}));
  EXPECT_EQ(is_on("#17"), (std::vector{false, false, true}));
  EXPECT_EQ(is_on("rest - #17"), (std::vector{true, true, false}));
}

TEST(Selection, UnknownLabelsAreErrors) {
  const StructureGraph graph = *StructureGraph::build({{.id = "a", .name = "Area", .label = 16},
                                                       {.id = "b", .label = -3},
                                                       {.id = "c", .label = 40},
                                                       {.id = "d", .label = 40}});
  const auto error = [&](const char* text) { return Selection::parse(text, graph).error(); };
  EXPECT_EQ(error("a + #17").code, ErrorCode::kNotFound);
  EXPECT_EQ(error("a + #17").message,
            "selection, column 5: no structure has the label 17; splatlas-player info --json lists them");
  EXPECT_THAT(error("rest + #17").message, HasSubstr("column 8: no structure has the label 17"));
  EXPECT_THAT(error("#40").message, HasSubstr("stands for 2 structures"));
}

/// FreeSurfer's names hold hyphens, which remove structures outside quotes.
TEST(Selection, NamesWithHyphensNeedQuotes) {
  const StructureGraph graph = *StructureGraph::build(
      {{.id = "a", .name = "Left-Hippocampus"}, {.id = "lh", .name = "ctx-lh-insula"}});
  const auto message = [&](const char* text) { return Selection::parse(text, graph).error().message; };
  EXPECT_THAT(message("Left-Hippocampus:surface"), HasSubstr("; write \"Left-Hippocampus\" in quotes"));
  EXPECT_THAT(message("a + ctx-lh-insula"), HasSubstr("; write \"ctx-lh-insula\" in quotes"));
  EXPECT_THAT(message("Right-Hippocampus"), testing::Not(HasSubstr("in quotes")));
}

TEST(Selection, EverythingOfNothingIsNothing) {
  const StructureGraph none = *StructureGraph::build({});
  for (const char* text : {"*", "*:surface", "\"*\":both(opacity=0.5)", "* - *", ""}) {
    const auto selection = value_or_throw(Selection::parse(text, none));
    EXPECT_TRUE(selection.structures.empty());
  }
  for (const char* text : {"A", "A*", "**", "*/*"}) {
    EXPECT_THAT(Selection::parse(text, none), FailsWith(ErrorCode::kNotFound, HasSubstr("there are none")))
        << text;
  }
}

TEST(Selection, WildcardsSelectDescendantsToo) {
  EXPECT_EQ(selected("L*"),
            (std::vector<StructureDraw>{kOff, draw(kVolume, kRed, 0), kOff, draw(kVolume, kGreen, 0),
                                        draw(kVolume, kBlue, 0), draw(kVolume, kBlue, 0)}));
  for (const StructureDraw& d : selected("*:both")) EXPECT_EQ(d.mode, kBoth);
}

TEST(Selection, UnknownNamesTellTheirColumn) {
  EXPECT_THAT(Selection::parse("A + \"Brian\"", brain()),
              FailsWith(ErrorCode::kNotFound, AllOf(HasSubstr("column 5: no structure is called \"Brian\""),
                                                    HasSubstr("\"Brain\""))));
  EXPECT_THAT(Selection::parse("A +", brain()), FailsWith(ErrorCode::kUsage, testing::_));
}

TEST(Selection, StylesAreEqualWhenTheirCurvesAre) {
  const VolumeStyle a = selected("A(curve=1:0.5/2:0)")[3].volume;
  EXPECT_EQ(a, selected("A(curve=1:0.5/2:0)")[3].volume);
  EXPECT_NE(a, selected("A(curve=1:0.5/2:0:0.5)")[3].volume);
  EXPECT_NE(a, selected("A")[3].volume);
  EXPECT_NE(selected("A")[3].volume, a);
  EXPECT_NE(selected("A(low=1)")[3].volume, selected("A(high=1)")[3].volume);
  EXPECT_NE(selected("A(profile=thin)")[3].volume, selected("A(profile=hard)")[3].volume);
  EXPECT_EQ(selected("A(profile=soft)")[3].volume, VolumeStyle{});
}

/// The state of one structure, term by term, by the rules in selection.h.
StructureDraw fate_of(StructureIndex s, const std::vector<SelectionTerm>& terms,
                      const StructureGraph& graph) {
  bool volume = false;
  bool surface = false;
  StructureDraw result;
  for (std::uint32_t n = 0; n < terms.size(); ++n) {
    const SelectionTerm& term = terms[n];
    bool meant = false;
    for (StructureIndex t = 0; t < graph.size(); ++t) {
      if (graph[t].id != term.name) continue;
      const auto below = graph.descendants(t);
      meant = std::find(below.begin(), below.end(), s) != below.end();
    }
    if (!meant) continue;
    const bool unsaid = term.mode == DrawMode::kOff;
    if (term.remove) {
      if (unsaid || term.mode != kSurface) volume = false;
      if (unsaid || term.mode != kVolume) surface = false;
    } else {
      if (!volume && !surface) result = {.color = graph[s].color};
      if (unsaid || term.mode != kSurface) volume = true;
      if (term.mode == kSurface || term.mode == kBoth) surface = true;
      if (term.ghost != result.ghost) result.opacity.reset();
      if (term.ghost != result.ghost) result.color = graph[s].color;
      result.ghost = term.ghost;
      if (term.ghost) result.color = {144, 144, 144};
      if (term.opacity) result.opacity = term.opacity;
      if (term.color) result.color = *term.color;
      if (term.curve) result.volume = {.curve = term.curve};
      if (term.profile || term.low || term.high) result.volume.curve = nullptr;
      if (term.profile) result.volume.profile = *term.profile;
      if (term.low && result.volume.high && *result.volume.high <= *term.low) result.volume.high.reset();
      if (term.low) result.volume.low = term.low;
      if (term.high && result.volume.low && *result.volume.low >= *term.high) result.volume.low.reset();
      if (term.high) result.volume.high = term.high;
      result.term = n;
    }
  }
  if (!volume && !surface) return {};
  result.mode = volume ? (surface ? kBoth : kVolume) : kSurface;
  return result;
}

RC_GTEST_PROP(Selection, EveryStructureFollowsTheRules, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  std::vector<SelectionTerm> terms(random() % 8);
  for (SelectionTerm& term : terms) {
    term.name = graph[static_cast<StructureIndex>(random() % graph.size())].id;
    term.mode = static_cast<DrawMode>(random() % 4);
    term.remove = random() % 3 == 0;
    if (term.remove) continue;
    if (random() % 2 == 0) term.opacity = 0.25f * static_cast<float>(1 + random() % 4);
    if (random() % 3 == 0) term.color = default_color(random() % 4);
    term.ghost = random() % 4 == 0;
    set_random_style(term, random);
  }
  const auto selection = resolve_selection(terms, graph);
  RC_ASSERT(selection.has_value());
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    RC_ASSERT(selection->structures[s] == fate_of(s, terms, graph));
  }
}

/// Selections come from files: the task ends them.
TEST(Selection, BelongsToTheTask) {
  const auto terms = value_or_throw(parse_selection("A + Brain/Left/A + *"));
  std::stop_source stop;
  stop.request_stop();
  const TaskControl task(stop.get_token(), {});
  EXPECT_THROW(static_cast<void>(parse_selection("A")), Cancelled);
  EXPECT_THROW(static_cast<void>(resolve_selection({&terms[0], 1}, brain())), Cancelled);
  for (const std::string_view name : {"Brain/Left/A", "*"})
    EXPECT_THROW(static_cast<void>(brain().find(name)), Cancelled) << name;
}

/// Long texts use an index of the names.
TEST(Selection, FindsTheSameStructuresForManyTerms) {
  const StructureGraph graph =
      *StructureGraph::build({{.id = "a", .name = "Top", .label = 3},
                              {.id = "b", .name = "A", .parents = {0}},
                              {.id = "c", .name = "Twin", .label = 5, .parents = {1}},
                              {.id = "d", .name = "twin", .label = 5},
                              {.id = "e", .name = "rest", .parents = {0}},
                              {.id = "f", .name = "star*", .terms = {{"la", "Stella"}, {"la", "a"}}},
                              {.id = "g", .name = "Rim", .terms = {{"la", "Margo"}, {"la", "A/Twin"}}},
                              {.id = "h", .name = "Edge", .terms = {{"la", "Margo"}, {"la", "TWIN"}}}});
  for (const std::string term : {"A", "TOP", "twin", "A/Twin", "nobody", "#3", "#5", "#4", "*", "star*",
                                 "rest", "\"rest\"", "\"#3\"", "C", "stella", "margo"}) {
    const auto one = Selection::parse(term, graph);
    std::string text = term;
    for (int n = 0; n < 50; ++n) text += " + " + term;
    auto many = Selection::parse(text, graph);
    ASSERT_EQ(many.has_value(), one.has_value()) << term;
    if (!one) {
      EXPECT_EQ(many.error().message, one.error().message);
      continue;
    }
    for (StructureDraw& draw : many->structures) draw.term = 0;
    EXPECT_EQ(*many, *one) << term;
  }
}

}  // namespace
}  // namespace splatlas
