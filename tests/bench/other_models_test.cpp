// Octrees and per-level run models against the single run model.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "bench/experiments/class_octree.h"
#include "bench/experiments/level_runs.h"
#include "bench/experiments/run_collector.h"
#include "tests/format/random_content.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// The draw of every voxel of the grid, by brute force.
std::vector<std::uint32_t> draws_by_voxel(const AtlasContent& content,
                                          const std::vector<std::uint32_t>& draw_of_class) {
  std::vector<std::uint32_t> draws;
  for (const ClassId c : content.class_volume) draws.push_back(draw_of_class[c]);
  return draws;
}

/// The draws from runs, which must be ordered within their scanline, maximal and complete.
std::vector<std::uint32_t> draws_by_voxel(const FoundRuns& found, const Grid& grid, Axis axis) {
  std::vector<std::uint32_t> draws(static_cast<std::size_t>(grid.voxels()), kNotDrawn);
  const ScanOrder scan = ScanOrder::of(axis);
  std::size_t walked = 0;
  for (std::int64_t slice = 0; slice < grid.size[scan.slice_axis]; ++slice) {
    FoundRun before{0, 0, 0, kNotDrawn};
    for (const FoundRun& run : found.slice(slice)) {
      ++walked;
      RC_ASSERT(run.length > 0u);
      RC_ASSERT(std::int64_t{run.start} + run.length <= grid.size[scan.scan_axis]);
      RC_ASSERT(run.row >= before.row);
      if (run.row == before.row) {
        RC_ASSERT(run.start >= before.start + before.length + (run.draw == before.draw ? 1u : 0u));
      }
      before = run;
      Index3 at{};
      at[scan.slice_axis] = slice;
      at[scan.row_axis] = run.row;
      for (std::uint32_t n = 0; n < run.length; ++n) {
        at[scan.scan_axis] = std::int64_t{run.start} + n;
        draws[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))] = run.draw;
      }
    }
  }
  RC_ASSERT(walked == found.runs.size());
  return draws;
}

/// Random draws, at times shared by several classes, as for equal appearances.
std::vector<std::uint32_t> random_draws(const DrawPlan& plan, std::size_t classes, std::mt19937& random) {
  std::vector<std::uint32_t> draws = draws_by_class(plan, classes);
  const auto kinds = static_cast<std::uint32_t>(1 + random() % 4);
  for (std::uint32_t& draw : draws) {
    if (draw != kNotDrawn) draw %= kinds;
  }
  return draws;
}

RC_GTEST_PROP(OtherModels, FindTheVoxelsThatARunModelFinds, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {.max_side = 20});
  const auto atlas = open_in_memory(content);
  const Grid grid = storage_grid(content);
  const LevelRuns levels = LevelRuns::build(*atlas).value();
  const std::array octrees{ClassOctree(content.class_volume, grid.size, 1),
                           ClassOctree(content.class_volume, grid.size, 4),
                           ClassOctree(content.class_volume, grid.size, 8)};
  for (int n = 0; n < 4; ++n) {
    const DrawPlan plan = atlas->tree().plan(random_selection(atlas->graph(), random));
    const std::vector<std::uint32_t> draws = random_draws(plan, atlas->classes().size(), random);
    const std::vector<std::uint32_t> expected = draws_by_voxel(content, draws);
    RC_CLASSIFY(std::ranges::count(expected, kNotDrawn) < std::ssize(expected), "something is drawn");
    for (const Axis axis : kAxes) {
      const auto found = [&](const auto& collect) {
        RunCollector runs(drawn_box(plan, atlas->classes()), axis);
        collect(runs);
        return draws_by_voxel(runs.finish(), grid, axis);
      };
      RC_ASSERT(found([&](RunCollector& runs) { levels.collect(draws, axis, runs); }) == expected);
      for (const ClassOctree& octree : octrees) {
        RC_ASSERT(found([&](RunCollector& runs) { octree.collect(draws, runs); }) == expected);
      }
    }
  }
}

/// A cube of 16 voxels a side with a corner of `side` voxels of class 1.
ClassOctree corner_octree(std::int64_t side, std::int64_t leaf_side) {
  const Index3 size{16, 16, 16};
  const std::vector<bool> corner =
      make_mask(size, [&](auto i, auto j, auto k) { return i < side && j < side && k < side; });
  return {std::vector<ClassId>(corner.begin(), corner.end()), size, leaf_side};
}

TEST(ClassOctree, HalvesOnlyWhatIsNotOfOneClass) {
  EXPECT_EQ(corner_octree(0, 1).nodes(), 1u);
  EXPECT_EQ(corner_octree(16, 1).nodes(), 1u);
  EXPECT_EQ(corner_octree(8, 1).nodes(), 1u + 8);
  EXPECT_EQ(corner_octree(4, 1).nodes(), 1u + 8 + 8);
  EXPECT_EQ(corner_octree(1, 1).nodes(), 1u + 8 * 4);
}

TEST(ClassOctree, KeepsBricksWhereClassesMix) {
  EXPECT_EQ(corner_octree(8, 8).bricks(), 0u);
  EXPECT_EQ(corner_octree(7, 8).bricks(), 1u);
  EXPECT_EQ(corner_octree(9, 8).bricks(), 7u);
  EXPECT_EQ(corner_octree(9, 8).nodes(), 1u + 8);
}

TEST(RunCollector, UnitesRunsOfOneDrawThatTouchOrOverlap) {
  RunCollector collector({{0, 0, 0}, {31, 3, 3}}, Axis::kZ);
  collector.add(1, 2, 20, 4, 7);
  collector.add(1, 2, 5, 3, 7);
  collector.add(1, 2, 8, 2, 7);
  collector.add(1, 2, 6, 1, 7);
  collector.add(1, 2, 10, 1, 8);
  collector.add(3, 3, 0, 1, 7);
  const FoundRuns found = collector.finish();
  ASSERT_EQ(found.runs.size(), 4u);
  const auto runs = found.slice(1);
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].row, 2u);
  EXPECT_EQ(runs[0].start, 5u);
  EXPECT_EQ(runs[0].length, 5u);
  EXPECT_EQ(runs[1].draw, 8u);
  EXPECT_EQ(runs[2].start, 20u);
  EXPECT_EQ(found.slice(3).size(), 1u);
  EXPECT_TRUE(found.slice(0).empty());
  EXPECT_TRUE(found.slice(-1).empty());
  EXPECT_TRUE(found.slice(4).empty());
}

TEST(LevelRuns, TakesTheHighestStructureThatIsDrawnAlike) {
  // Two halves of a row of eight voxels, below one group.
  const auto atlas =
      open_in_memory(make_content({.grid = {.size = {8, 1, 1}},
                                   .structures = {{"All", {}},
                                                  {"Low", {1, 1, 1, 1, 0, 0, 0, 0}, {}, {0}},
                                                  {"High", {0, 0, 0, 0, 1, 1, 1, 1}, {}, {0}}}}));
  const LevelRuns levels = LevelRuns::build(*atlas).value();
  EXPECT_EQ(levels.runs(Axis::kZ), 2u + 3u);  // two classes; two structures and their group
  const auto runs_of = [&](const std::vector<std::uint32_t>& draws) {
    RunCollector runs({{0, 0, 0}, {7, 0, 0}}, Axis::kZ);
    levels.collect(draws, Axis::kZ, runs);
    return runs.finish().runs;
  };
  ASSERT_EQ(atlas->classes().size(), 3u);
  const auto whole = runs_of({kNotDrawn, 0, 0});
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].length, 8u);
  EXPECT_EQ(runs_of({kNotDrawn, 0, 1}).size(), 2u);
  EXPECT_EQ(runs_of({kNotDrawn, kNotDrawn, 1}).size(), 1u);
  EXPECT_EQ(runs_of({kNotDrawn, kNotDrawn, kNotDrawn}).size(), 0u);
}

}  // namespace
}  // namespace splatlas
