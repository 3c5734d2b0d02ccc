#include "format/content/decision_tree.h"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

using Members = std::vector<Membership>;

/// Voxels with their memberships, for brute-force evaluation.
struct Voxels {
  std::vector<Members> members;
  std::vector<ClassId> classes;
  ClassTable table;
};

Voxels random_voxels(const StructureGraph& graph, std::mt19937& random) {
  Voxels voxels;
  for (std::int64_t n = 0; n < 200; ++n) {
    Members members;
    for (StructureIndex s = 0; s < graph.size(); ++s) {
      if (below(graph.size() + 2, random) >= 2) continue;
      members.push_back({s, graph[s].external ? Part::kCrossed : static_cast<Part>(below(2, random))});
    }
    voxels.classes.push_back(voxels.table.intern(members));
    voxels.table.count(voxels.classes.back(), 1, {{n, 0, 0}, {n, 0, 0}});
    voxels.members.push_back(std::move(members));
  }
  return voxels;
}

/// The rules for one voxel, structure by structure.
ClassDraw draw_of(const Members& members, const Selection& selection) {
  bool volume = false, surface = false;
  ClassDraw draw;
  std::uint32_t latest = 0;
  for (const auto& [s, part] : members) {  // in index order
    const StructureDraw& appearance = selection.structures[s];
    if (appearance.mode == DrawMode::kOff) continue;
    const bool as_surface = appearance.mode == DrawMode::kSurface || appearance.mode == DrawMode::kBoth;
    const bool as_volume = appearance.mode == DrawMode::kVolume || appearance.mode == DrawMode::kBoth;
    if (part == Part::kCrossed || (part == Part::kBoundary && as_surface)) surface = true;
    if (part == Part::kCrossed || !as_volume) continue;
    if (!volume || appearance.term >= latest) {
      draw.volume_of = s;
      draw.boundary = part == Part::kBoundary;
      latest = appearance.term;
    }
    volume = true;
  }
  if (volume) draw.role = surface ? VoxelRole::kHybrid : VoxelRole::kVolume;
  if (!volume && surface) draw.role = VoxelRole::kSurface;
  return draw;
}

RC_GTEST_PROP(DecisionTree, PlansWhatEveryVoxelSays, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const Voxels voxels = random_voxels(graph, random);
  Selection selection = random_selection(graph, random);
  for (StructureDraw& draw : selection.structures)
    draw.term = std::uniform_int_distribution<unsigned>(0, 2)(random);
  const DecisionTree tree(graph, voxels.table);

  const DrawPlan plan = tree.plan(selection);

  std::vector<ClassDraw> planned(voxels.table.size());
  ClassId before = 0;
  for (const ClassDraw& draw : plan.classes) {
    RC_ASSERT(draw.id > before);
    RC_ASSERT(draw.role != VoxelRole::kNone);
    before = draw.id;
    planned[draw.id] = draw;
  }
  std::uint64_t volume = 0, surface = 0, hybrid = 0;
  for (std::size_t v = 0; v < voxels.members.size(); ++v) {
    ClassDraw expected = draw_of(voxels.members[v], selection);
    if (expected.role != VoxelRole::kNone) expected.id = voxels.classes[v];
    RC_ASSERT(planned[voxels.classes[v]] == expected);
    volume += expected.role == VoxelRole::kVolume;
    surface += expected.role == VoxelRole::kSurface;
    hybrid += expected.role == VoxelRole::kHybrid;
  }
  RC_ASSERT(plan.volume_voxels == volume);
  RC_ASSERT(plan.surface_voxels == surface);
  RC_ASSERT(plan.hybrid_voxels == hybrid);

  std::vector<StructureIndex> surfaces;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const DrawMode mode = selection.structures[s].mode;
    const bool drawn = mode != DrawMode::kOff && (graph[s].external || mode != DrawMode::kVolume);
    const auto in_boundary = [&](const Membership& m) {
      return m.structure == s && m.part != Part::kInterior;
    };
    const bool has_boundary = std::ranges::any_of(
        voxels.members, [&](const Members& members) { return std::ranges::any_of(members, in_boundary); });
    if (drawn && has_boundary) surfaces.push_back(s);
  }
  RC_ASSERT(plan.surfaces == surfaces);
}

RC_GTEST_PROP(DecisionTree, LeavesAreTheClassesOfAStructureItself, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const ClassTable table = random_voxels(graph, random).table;
  const DecisionTree tree(graph, table);
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    std::vector<ClassId> interior, boundary;
    for (ClassId c = 0; c < table.size(); ++c) {
      for (const Membership& m : table.members(c)) {
        if (m.structure == s) (m.part == Part::kInterior ? interior : boundary).push_back(c);
      }
    }
    RC_ASSERT(std::ranges::equal(tree.interior_classes(s), interior));
    RC_ASSERT(std::ranges::equal(tree.boundary_classes(s), boundary));
  }
}

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
