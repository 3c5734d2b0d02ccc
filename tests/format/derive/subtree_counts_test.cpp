#include "format/derive/subtree_counts.h"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

/// Classes of up to three random structures, with random counts.
ClassTable random_class_table(std::size_t structures, std::mt19937& random) {
  ClassTable classes;
  for (std::size_t n = 0; n < 2 * structures; ++n) {
    std::vector<Membership> members;
    for (std::size_t m = 0; m <= below(3, random); ++m) {
      members.push_back(
          {static_cast<StructureIndex>(below(structures, random)), static_cast<Part>(below(3, random))});
    }
    classes.count(classes.intern(members), 1 + below(1000, random), {{0, 0, 0}, {0, 0, 0}});
  }
  return classes;
}

RC_GTEST_PROP(SubtreeCounts, EqualSetsOfDescendants, ()) {
  auto random = *random_source();
  const auto structures = *rc::gen::inRange<std::size_t>(1, 200);  // more than a batch
  const StructureGraph graph = random_graph(structures, random);
  const ClassTable classes = random_class_table(structures, random);
  std::vector<std::uint64_t> triangles(structures);
  for (std::uint64_t& n : triangles) n = below(1000, random);
  const std::vector<SubtreeCounts> counts =
      subtree_counts(graph, classes, DecisionTree(graph, classes), triangles);
  RC_ASSERT(counts.size() == structures);
  for (StructureIndex s = 0; s < structures; ++s) {
    const auto list = graph.descendants(s);
    const std::set<StructureIndex> group(list.begin(), list.end());
    SubtreeCounts expected;
    for (const StructureIndex d : group) expected.triangles += triangles[d];
    for (ClassId c = 0; c < classes.size(); ++c) {
      bool in = false, on = false;
      for (const Membership& m : classes.members(c)) {
        if (group.contains(m.structure)) (m.part == Part::kInterior ? in : on) = true;
      }
      if (on) expected.boundary += classes.voxels(c);
      if (in && !on) expected.interior += classes.voxels(c);
    }
    RC_ASSERT(counts[s] == expected);
  }
}

TEST(SubtreeCounts, OfNothingAreNone) {
  const StructureGraph graph;
  const ClassTable classes;
  EXPECT_TRUE(subtree_counts(graph, classes, DecisionTree(graph, classes), {}).empty());
}

}  // namespace
}  // namespace splatlas
