#include "format/content/structure_graph.h"

#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"
#include "tests/support/fails_with.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

std::vector<StructureIndex> list(std::span<const StructureIndex> indices) {
  return {indices.begin(), indices.end()};
}

/// Two hierarchies in one graph: a gyrus belongs to a side and to a lobe.
StructureGraph brain() {
  return *StructureGraph::build({
      {.id = "brain", .name = "Brain"},                       // 0
      {.id = "left", .name = "Left", .parents = {0}},         // 1
      {.id = "right", .name = "Right", .parents = {0}},       // 2
      {.id = "gyrus_l", .name = "Gyrus", .parents = {1, 5}},  // 3
      {.id = "gyrus_r", .name = "Gyrus", .parents = {2, 5}},  // 4
      {.id = "frontal", .name = "Frontal", .parents = {6}},   // 5
      {.id = "lobes", .name = "Lobes"},                       // 6
  });
}

TEST(StructureGraph, ListsChildrenAndRoots) {
  const StructureGraph graph = brain();
  EXPECT_EQ(graph.size(), 7u);
  EXPECT_THAT(list(graph.roots()), ElementsAre(0, 6));
  EXPECT_THAT(list(graph.children(0)), ElementsAre(1, 2));
  EXPECT_THAT(list(graph.children(5)), ElementsAre(3, 4));
  EXPECT_THAT(list(graph.children(4)), IsEmpty());
  EXPECT_EQ(graph[3].id, "gyrus_l");
}

TEST(StructureGraph, ListsEveryWayFromARoot) {
  const StructureGraph graph = brain();
  EXPECT_THAT(graph.paths(0), ElementsAre("Brain"));
  EXPECT_THAT(graph.paths(4), ElementsAre("Brain/Right/Gyrus", "Lobes/Frontal/Gyrus"));
  EXPECT_THAT(graph.paths(4, 1), ElementsAre("Brain/Right/Gyrus"));
  EXPECT_THAT(graph.paths(4, 0), IsEmpty());
}

TEST(StructureGraph, AnEmptyOneIsFine) {
  const auto graph = value_or_throw(StructureGraph::build({}));
  EXPECT_EQ(graph.size(), 0u);
  EXPECT_THAT(list(graph.preorder()), IsEmpty());
}

TEST(StructureGraph, RefusesEachFault) {
  const std::vector<std::pair<std::vector<Structure>, const char*>> faults{
      {{{.id = "", .name = "Nameless"}}, "structure 0 (\"Nameless\") has no id"},
      {{{.id = "a"}, {.id = "b"}, {.id = "A"}}, "two structures have the id \"A\""},
      {{{.id = "left hemisphere"}}, "\"left hemisphere\""},
      {{{.id = "a/b"}}, "\"a/b\""},
      {{{.id = "a\nb"}}, "\"a?b\""},
      {{{.id = "gro\xc3\x9f"}}, "letters, digits"},
      {{{.id = "a", .parents = {1}}}, "structure \"a\" has parent number 1 of 1 structures"},
      {{{.id = "a", .parents = {kNoStructure}}}, "structure \"a\" has parent number 4294967295"},
      {{{.id = "a"}, {.id = "b", .parents = {0, 0}}}, "structure \"b\" has the parent \"a\" twice"},
      {{{.id = "a", .parents = {0}}}, "a in a"},
      {{{.id = "a", .parents = {1}}, {.id = "b", .parents = {0}}}, "a in b in a"},
      {{{.id = "root"},
        {.id = "below", .parents = {0, 4}},
        {.id = "x", .parents = {3, 0}},
        {.id = "y", .parents = {4}},
        {.id = "z", .parents = {0, 2}}},
       "z in x in y in z"},
  };
  for (const auto& [structures, part] : faults) {
    EXPECT_THAT(StructureGraph::build(structures),
                FailsWith(ErrorCode::kInvalidAtlas, AllOf(HasSubstr(part), Not(HasSubstr("\n")))));
  }
}

std::vector<Structure> chain(std::size_t n) {
  std::vector<Structure> structures(n);
  for (std::size_t s = 0; s < n; ++s) {
    structures[s].id = fmt::format("s{}", s);
    if (s > 0) structures[s].parents = {static_cast<StructureIndex>(s - 1)};
  }
  return structures;
}

TEST(StructureGraph, DepthIsLimited) {
  EXPECT_TRUE(StructureGraph::build(chain(kMaxGraphDepth)));
  EXPECT_THAT(message_of(StructureGraph::build(chain(kMaxGraphDepth + 1))),
              HasSubstr("\"s256\" lies deeper than 256 levels"));
}

TEST(StructureGraph, HostileDepthAndLengthAreOnlyErrors) {
  EXPECT_FALSE(StructureGraph::build(chain(kMaxStructures)));
  EXPECT_FALSE(StructureGraph::build(std::vector<Structure>(kMaxStructures + 1)));
  auto circle = chain(100'000);
  circle[0].parents = {99'999};
  const std::string fault = message_of(StructureGraph::build(circle));
  EXPECT_THAT(fault, HasSubstr("s0 in s99999 in s99998 in "));
  EXPECT_LT(fault.size(), 300u);
}

TEST(StructureGraph, ManyWaysCostNothingUntilTheyAreListed) {
  // 100 levels of two structures, each below both of the previous level: 2^99 paths.
  std::vector<Structure> structures(200);
  for (std::size_t s = 0; s < structures.size(); ++s) {
    structures[s].id = structures[s].name = fmt::format("s{}", s);
    const auto level = static_cast<StructureIndex>(s / 2 * 2);
    if (s >= 2) structures[s].parents = {level - 2, level - 1};
  }
  const auto graph = value_or_throw(StructureGraph::build(structures));
  EXPECT_EQ(graph.preorder().size(), 200u);
  EXPECT_EQ(graph.descendants(0).size(), 199u);
  EXPECT_EQ(graph.paths(199).size(), 64u);
}

RC_GTEST_PROP(StructureGraph, OrdersFollowTheirDefinitions, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);

  // Recursive versions of the iterative traversals.
  std::vector<StructureIndex> visited;
  const std::function<void(StructureIndex)> visit = [&](StructureIndex s) {
    if (std::find(visited.begin(), visited.end(), s) != visited.end()) return;
    visited.push_back(s);
    for (const StructureIndex child : graph.children(s)) visit(child);
  };
  for (const StructureIndex root : graph.roots()) visit(root);
  RC_ASSERT(list(graph.preorder()) == visited);
  RC_ASSERT(graph.descendants(graph.roots()) == visited);

  std::set<StructureIndex> before;
  for (const StructureIndex s : graph.topological()) {
    for (const StructureIndex parent : graph[s].parents) RC_ASSERT(before.contains(parent));
    RC_ASSERT(before.insert(s).second);
  }
  RC_ASSERT(before.size() == graph.size());

  const std::function<std::vector<std::string>(StructureIndex)> paths = [&](StructureIndex s) {
    std::vector<std::string> result;
    if (graph[s].parents.empty()) result.push_back(graph[s].name);
    for (const StructureIndex parent : graph[s].parents) {
      for (const std::string& path : paths(parent)) result.push_back(path + "/" + graph[s].name);
    }
    return result;
  };
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    visited.clear();
    visit(s);
    RC_ASSERT(graph.descendants(s) == visited);
    RC_ASSERT(graph.paths(s, 1'000'000) == paths(s));
    for (const StructureIndex child : graph.children(s)) {
      RC_ASSERT(std::find(graph[child].parents.begin(), graph[child].parents.end(), s) !=
                graph[child].parents.end());
    }
  }
}

TEST(IdFromName, KeepsLettersAndDigits) {
  EXPECT_EQ(id_from_name("Left hemisphere"), "Left_hemisphere");
  EXPECT_EQ(id_from_name("Frontal_Sup_L"), "Frontal_Sup_L");
  EXPECT_EQ(id_from_name("Vermis 4/5"), "Vermis_4_5");
  EXPECT_EQ(id_from_name("  (a) --  b. "), "a_b");
  EXPECT_EQ(id_from_name("S\xc3\xbc"
                         "d"),
            "S_d");
  EXPECT_EQ(id_from_name(""), "structure");
  EXPECT_EQ(id_from_name("*\xe2\x80\x94/"), "structure");
}

RC_GTEST_PROP(IdFromName, IsAlwaysAnId, (const std::string& name)) {
  const std::string id = id_from_name(name);
  RC_ASSERT(StructureGraph::build({{.id = id, .name = name}}).has_value());
  RC_ASSERT(id_from_name(id) == id);
}

}  // namespace
}  // namespace splatlas
