#include "format/content/decision_tree.h"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"

namespace splatlas {
namespace {

using Members = std::vector<Membership>;

/// The paper's phantom: two disjoint balls in 32x32x32 voxels (table 1).
struct Phantom {
  StructureGraph graph = *StructureGraph::build({{.id = "large"}, {.id = "small"}});
  ClassTable classes;
  Phantom() {
    const std::array<std::uint64_t, 5> voxels{27722, 2705, 1440, 437, 464};
    classes.intern({{0, Part::kInterior}});
    classes.intern({{0, Part::kBoundary}});
    classes.intern({{1, Part::kInterior}});
    classes.intern({{1, Part::kBoundary}});
    for (ClassId c = 0; c < voxels.size(); ++c) classes.count(c, voxels[c], {{0, 0, 0}, {31, 31, 31}});
  }
};

TEST(DecisionTree, GivesTheVoxelsOfThePapersTableTwo) {
  const Phantom phantom;
  const DecisionTree tree(phantom.graph, phantom.classes);
  struct Row {
    const char* text;
    std::uint64_t volume, surface, hybrid;
  };
  for (const auto& [text, volume, surface, hybrid] :
       {Row{"*:surface", 0, 1904, 0}, Row{"*:volume", 5046, 0, 0},
        Row{"large:surface + small:both", 437, 1440, 464}, Row{"large:volume + small:surface", 4145, 464, 0},
        Row{"", 0, 0, 0}, Row{"* - large", 901, 0, 0}}) {
    const DrawPlan plan = tree.plan(*Selection::parse(text, phantom.graph));
    EXPECT_EQ(plan.volume_voxels, volume) << text;
    EXPECT_EQ(plan.surface_voxels, surface) << text;
    EXPECT_EQ(plan.hybrid_voxels, hybrid) << text;
  }
  EXPECT_EQ(tree.voxel_counts(0).interior, 2705u);
  EXPECT_EQ(tree.voxel_counts(1).boundary, 464u);
}

TEST(DecisionTree, ListsClassesAndSurfacesToDraw) {
  const Phantom phantom;
  const DecisionTree tree(phantom.graph, phantom.classes);
  const DrawPlan plan = tree.plan(*Selection::parse("large:surface + small:both", phantom.graph));
  EXPECT_EQ(plan.classes, (std::vector<ClassDraw>{{2, VoxelRole::kSurface, kNoStructure, false},
                                                  {3, VoxelRole::kVolume, 1, false},
                                                  {4, VoxelRole::kHybrid, 1, true}}));
  EXPECT_EQ(plan.surfaces, (std::vector<StructureIndex>{0, 1}));
  EXPECT_TRUE(tree.plan(*Selection::parse("*", phantom.graph)).surfaces.empty());
}

TEST(DecisionTree, TheLatestTermThenTheHigherIndexGivesTheAppearance) {
  const auto graph =
      *StructureGraph::build({{.id = "whole"}, {.id = "part", .parents = {0}}, {.id = "other"}});
  ClassTable classes;
  const ClassId shared = classes.intern({{0, Part::kInterior}, {1, Part::kBoundary}, {2, Part::kInterior}});
  const DecisionTree tree(graph, classes);
  const auto appearance = [&](const char* text) {
    return tree.plan(*Selection::parse(text, graph)).classes.at(0);
  };
  EXPECT_EQ(appearance("whole"), (ClassDraw{shared, VoxelRole::kVolume, 1, true}));
  EXPECT_EQ(appearance("*"), (ClassDraw{shared, VoxelRole::kVolume, 2, false}));
  EXPECT_EQ(appearance("other + whole"), (ClassDraw{shared, VoxelRole::kVolume, 1, true}));
  EXPECT_EQ(appearance("whole + other"), (ClassDraw{shared, VoxelRole::kVolume, 2, false}));
  EXPECT_EQ(appearance("whole + other:surface"), (ClassDraw{shared, VoxelRole::kVolume, 1, true}));
  EXPECT_EQ(appearance("other + part:surface"), (ClassDraw{shared, VoxelRole::kHybrid, 2, false}));
  EXPECT_EQ(appearance("part:surface"), (ClassDraw{shared, VoxelRole::kSurface, kNoStructure, false}));
}

TEST(DecisionTree, ExternalSurfacesAreDrawnInEveryMode) {
  const auto graph = *StructureGraph::build({{.id = "bone"}, {.id = "needle", .external = true}});
  ClassTable classes;
  const ClassId alone = classes.intern({{1, Part::kCrossed}});
  const ClassId in_bone = classes.intern({{0, Part::kInterior}, {1, Part::kCrossed}});
  const DecisionTree tree(graph, classes);
  for (const char* text : {"needle:volume", "needle:surface", "needle:both"}) {
    const DrawPlan plan = tree.plan(*Selection::parse(text, graph));
    EXPECT_EQ(plan.classes, (std::vector<ClassDraw>{{alone, VoxelRole::kSurface, kNoStructure, false},
                                                    {in_bone, VoxelRole::kSurface, kNoStructure, false}}));
    EXPECT_EQ(plan.surfaces, (std::vector<StructureIndex>{1}));
  }
  const DrawPlan both = tree.plan(*Selection::parse("bone + needle:surface", graph));
  EXPECT_EQ(both.classes[1], (ClassDraw{in_bone, VoxelRole::kHybrid, 0, false}));
}

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

RC_GTEST_PROP(DecisionTree, CountsEachVoxelOnce, ()) {
  auto random = *random_source();
  const StructureGraph graph = random_graph(random);
  const Voxels voxels = random_voxels(graph, random);
  const DecisionTree tree(graph, voxels.table);
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const auto below = graph.descendants(s);
    const std::set<StructureIndex> group(below.begin(), below.end());
    std::uint64_t interior = 0, boundary = 0;
    for (const Members& members : voxels.members) {
      bool in = false, on = false;
      for (const Membership& m : members) {
        if (group.contains(m.structure)) (m.part == Part::kInterior ? in : on) = true;
      }
      boundary += on;
      interior += in && !on;
    }
    RC_ASSERT(tree.voxel_counts(s).interior == interior);
    RC_ASSERT(tree.voxel_counts(s).boundary == boundary);
  }
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

}  // namespace
}  // namespace splatlas
