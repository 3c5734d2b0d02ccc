#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/content/selection.h"
#include "tests/format/random_graph.h"
#include "tests/support/fails_with.h"
#include "tests/support/find_slowly.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

StructureGraph brain() {
  return *StructureGraph::build({
      {.id = "brain", .name = "Brain"},                               // 0
      {.id = "cerebellum", .name = "Cerebellum", .parents = {0}},     // 1
      {.id = "cb_l", .name = "Left", .parents = {1}},                 // 2
      {.id = "cerebrum", .name = "Cerebrum", .parents = {0}},         // 3
      {.id = "cr_l", .name = "Left", .parents = {3}},                 // 4
      {.id = "right", .name = "Brain/Right", .parents = {3}},         // 5
      {.id = "hc_l", .name = "Hippocampus left", .parents = {4, 7}},  // 6
      {.id = "limbic", .name = "Limbic"},                             // 7
      {.id = "Limb", .name = "cerebrum"},                             // 8: named like another's id
  });
}

std::vector<StructureIndex> found(std::string_view name) {
  const auto result = brain().find(name);
  if (result) return *result;
  ADD_FAILURE() << result.error().message;
  return {};
}

std::string refusal(std::string_view name) {
  const auto result = brain().find(name);
  if (result) {
    ADD_FAILURE() << name << " was found";
    return {};
  }
  EXPECT_EQ(result.error().code, ErrorCode::kNotFound);
  return result.error().message;
}

TEST(FindStructures, IdsWinOverNamesAndNamesOverPaths) {
  EXPECT_THAT(found("cerebrum"), ElementsAre(3));     // not structure 8 of that name
  EXPECT_THAT(found("Brain/Right"), ElementsAre(5));  // a name with a "/" of its own
  EXPECT_THAT(found("cerebrum/brain/right"), ElementsAre(5));
}

TEST(FindStructures, AmbiguousNamesListTheCandidates) {
  const std::string message = refusal("Left");
  EXPECT_THAT(message, HasSubstr("\"Left\" stands for 2 structures"));
  EXPECT_THAT(message, HasSubstr("\"Brain/Cerebellum/Left\" (id cb_l)"));
  EXPECT_THAT(message, HasSubstr("\"Brain/Cerebrum/Left\" (id cr_l)"));
}

/// Two halves of a ball with synonyms, in a group called as one of these.
StructureGraph ball() {
  return *StructureGraph::build(
      {{.id = "core", .name = "Core"},  // 0
       {.id = "west",
        .name = "Left half",
        .parents = {0},
        .terms = {{"AAL", "Half_L"}, {"la", "Pars"}, {"synonym", "PARS"}}},  // 1
       {.id = "east",
        .name = "Right half",
        .parents = {0},
        .terms = {{"AAL", "Half_R"}, {"synonym", "Core"}}},                                    // 2
       {.id = "c", .name = "Rim", .terms = {{"la", "Margo"}, {"synonym", "Core/Left half"}}},  // 3
       {.id = "d", .name = "Edge", .terms = {{"la", "Margo"}, {"SNOMED", "4033"}}}});          // 4
}

TEST(FindStructures, TermsCountWhereNothingElseFits) {
  const StructureGraph graph = ball();
  for (const auto& [text, expected] : {std::pair<const char*, std::vector<StructureIndex>>{"half_l", {1}},
                                       {"Pars", {1}},  // one structure, although two of its terms fit
                                       {"4033", {4}},
                                       {"core", {0}},
                                       {"core/left half", {1}},  // a path
                                       {"Half_*", {1, 2}},
                                       {"marg*", {3, 4}},
                                       {"c*e", {0}}}) {  // the name hides the term of structure 2
    const auto found = value_or_throw(graph.find(text));
    EXPECT_EQ(found, expected) << text;
  }
  EXPECT_EQ(
      message_of(graph.find("margo")),
      "\"margo\" stands for 2 structures, write a longer path or an id: \"Rim\" (id c), \"Edge\" (id d)");
  EXPECT_THAT(message_of(graph.find("Half_S")), HasSubstr("the nearest: \"Half_L\", \"Half_R\", "));
  EXPECT_THAT(message_of(graph.find("Left hulf")), HasSubstr("the nearest: \"Left half\", "));
}

TEST(FindStructures, ListsOfCandidatesEnd) {
  std::vector<Structure> structures(20);
  for (std::size_t s = 0; s < structures.size(); ++s) {
    structures[s].id = fmt::format("s{}", s);
    structures[s].name = "Same";
  }
  const std::string message = message_of(StructureGraph::build(structures)->find("same"));
  EXPECT_THAT(message, HasSubstr("stands for 20 structures"));
  EXPECT_THAT(message, HasSubstr("\"Same\" (id s4), 15 more"));
  EXPECT_THAT(message, Not(HasSubstr("id s5")));
}

TEST(FindStructures, UnknownNamesListTheNearest) {
  EXPECT_THAT(refusal("cerebelum"), HasSubstr("the nearest: \"Cerebellum\", "));
  EXPECT_THAT(refusal("hippocampus"),
              HasSubstr("the nearest: \"Hippocampus left\", "));  // 5 edits, but it contains the name
  EXPECT_THAT(refusal("LIMBID"), HasSubstr("the nearest: \"Limbic\", "));
  const std::string message = refusal("zzz");
  EXPECT_EQ(std::count(message.begin(), message.end(), '"'), 12) << message;  // the name and five others
  EXPECT_THAT(message_of(StructureGraph{}.find("x")),
              HasSubstr("no structure is called \"x\"; there are none"));
  EXPECT_LT(refusal(std::string(100'000, 'x')).size(), 400u);
}

TEST(FindStructures, TheNearestListEachStructureOnce) {
  std::vector<Structure> structures(2);
  structures[0].id = "Left_cerebellum";
  structures[0].name = "Left cerebellum";
  structures[1].id = "v9";
  structures[1].name = "Vermis IX";
  const StructureGraph graph = *StructureGraph::build(structures);
  const auto nearest = [&](const char* text) { return graph.find(text).error().message; };
  EXPECT_THAT(nearest("Left cerebelum"), HasSubstr("the nearest: \"Left cerebellum\", \"Vermis IX\""));
  EXPECT_THAT(nearest("Left cerebelum"), Not(HasSubstr("_")));
  EXPECT_THAT(nearest("Left_cerebelum"), HasSubstr("the nearest: \"Left_cerebellum\", "));
  EXPECT_THAT(nearest("v8"), HasSubstr("the nearest: \"v9\", "));
}

TEST(FindNamed, TakesNamesQuotedOrNotAndLabels) {
  const StructureGraph graph = *StructureGraph::build({{.id = "a", .name = "Left cerebrum", .label = 3},
                                                       {.id = "b", .name = "rest"},
                                                       {.id = "c", .name = "#3"}});
  for (const auto& [text, expected] : {std::pair<const char*, StructureIndex>{"left cerebrum", 0},
                                       {"\"Left cerebrum\"", 0},
                                       {"\"a\" ", 0},
                                       {"#3", 0},
                                       {"rest", 1},
                                       {"\"rest\"", 1},
                                       {"\"#3\"", 2},
                                       {"*rebrum", 0}}) {
    const auto found = value_or_throw(graph.find_named(text));
    EXPECT_THAT(found, ElementsAre(expected)) << text;
  }
  EXPECT_THAT(graph.find_named("#4"), FailsWith(ErrorCode::kNotFound, HasSubstr("has the label 4")));
  EXPECT_THAT(graph.find_named("d"), FailsWith(ErrorCode::kNotFound, HasSubstr("the nearest: ")));
  EXPECT_THAT(graph.find_named("\"a"), FailsWith(ErrorCode::kUsage, HasSubstr("never closed")));
  EXPECT_THAT(graph.find_named("\"a\":surface"), FailsWith(ErrorCode::kUsage, HasSubstr("behind the name")));
  EXPECT_THAT(graph.find_named("#x"), FailsWith(ErrorCode::kUsage, HasSubstr("not a label")));
}

TEST(FindStructures, ManyWaysToAStructureTakeNoLonger) {
  std::vector<Structure> structures(200);  // 2^99 paths to the last
  for (std::size_t s = 0; s < structures.size(); ++s) {
    structures[s].id = fmt::format("s{}", s);
    structures[s].name = "n";
    const auto level = static_cast<StructureIndex>(s / 2 * 2);
    if (s >= 2) structures[s].parents = {level - 2, level - 1};
  }
  structures.back().name = "last";
  const StructureGraph graph = *StructureGraph::build(structures);
  std::string path = "n";
  for (int n = 1; n < 99; ++n) path += "/n";
  EXPECT_THAT(*graph.find(path + "/last"), ElementsAre(199));
  EXPECT_THAT(*graph.find("n/*n/n/last"), ElementsAre(199));
  EXPECT_FALSE(graph.find("x" + path + "/last"));
  EXPECT_FALSE(graph.find("n/*x*/last"));
}

RC_GTEST_PROP(FindStructures, AgreesWithItsDefinition, ()) {
  const auto count = *uniform<std::size_t>(1, 10);
  auto random = *random_source();
  // Plain names: a suffix may not begin inside a name that contains "/".
  std::vector<Structure> structures(count);
  const StructureGraph shape = random_graph(count, random);
  for (StructureIndex s = 0; s < count; ++s) {
    structures[s] = shape[s];
    structures[s].name = std::vector{"Left", "Right", "lobe", "Gyrus of A", "x"}[random() % 5];
    if (random() % 2 == 0) structures[s].terms = {{"la", random() % 2 == 0 ? "lobus" : "Dexter"}};
  }
  const StructureGraph graph = *StructureGraph::build(structures);

  const auto s = static_cast<StructureIndex>(random() % count);
  const auto paths = graph.paths(s);
  std::string name = paths[random() % paths.size()];
  if (random() % 3 == 0) name = graph[s].id;
  if (random() % 3 == 0 && !graph[s].terms.empty()) name = graph[s].terms.front().value;
  if (random() % 2 == 0) name = name.substr(random() % name.size());
  if (random() % 3 == 0) name[random() % name.size()] = '*';
  if (random() % 4 == 0) name = name.substr(name.find('/') + 1);
  RC_PRE(!name.empty());

  const auto expected = find_slowly(graph, name);
  const auto result = graph.find(name);
  const bool unique_or_wild = expected.size() == 1 || name.find('*') != std::string::npos;
  RC_LOG() << name;
  RC_ASSERT(result.has_value() == (!expected.empty() && unique_or_wild));
  if (result) RC_ASSERT(*result == expected);
}

}  // namespace
}  // namespace splatlas
