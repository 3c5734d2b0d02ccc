#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/format/random_volume.h"
#include "tests/support/fails_with.h"
#include "tests/support/fit_parts.h"
#include "tests/support/sparse_atlas.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(WorkBudget, GrowsWithTheFile) {
  EXPECT_EQ(WorkBudget("F", 100, 1).allowed(), 3e10);
  EXPECT_EQ(WorkBudget("F", 1 << 20, 1).allowed(), 3e10);
  EXPECT_EQ(WorkBudget("F", (1 << 20) + 5, 1).allowed(), 3e10 + 5e4);
  EXPECT_EQ(WorkBudget("F", 100, 2.5).allowed(), 7.5e10);
  EXPECT_EQ(WorkBudget("F", 100, 0.5).allowed(), 1.5e10);
  EXPECT_EQ(WorkBudget("F", 100, std::nan("")).allowed(), 3e10);
}

TEST(WorkBudget, NamesNumberAndOption) {
  Work work;
  work.add(WorkKind::kRuns, 1e6, 1000);
  work.add(WorkKind::kBytes, 1e10, 10);
  EXPECT_EQ(work.units(), 1.01e11);
  const Result<void> refused = WorkBudget("a.atlas", 21234, 1).check(work, "the selection");
  EXPECT_THAT(
      refused,
      FailsWith(ErrorCode::kLimit,
                "a.atlas: the selection takes 1.01e+11 units of work (1e+10 decoded bytes); a file of "
                "21234 bytes may take 3e+10. If you trust the file, allow it with --max-work 4"));
  EXPECT_TRUE(WorkBudget("a.atlas", 21234, 4).check(work, "the selection"));
  EXPECT_FALSE(WorkBudget("a.atlas", 21234, 3).check(work, "the selection"));
}

/// A file may hold half of the memory. Steps follow one another: their memory does not add up.
TEST(WorkBudget, CountsMemory) {
  Work work, step;
  step.hold(150e6);
  for (int n = 0; n < 5; ++n) work += step;
  EXPECT_EQ(work.units(), 6e8);
  work.hold(210e6);
  EXPECT_TRUE(WorkBudget("F", 1, 1, 420'000'000).check(work, "it"));
  EXPECT_THAT(
      WorkBudget("F", 1, 1, 400'000'000).check(work, "it"),
      FailsWith(ErrorCode::kLimit, AllOf(HasSubstr("it holds 200 MiB at once; a file may take 191 MiB"),
                                         HasSubstr("--max-work 2"))));
  EXPECT_THAT(WorkBudget("F", 1, 0.5, 420'000'001).check(work, "it"),
              FailsWith(ErrorCode::kLimit, EndsWith("--max-work 1")));
}

TEST(WorkBudget, AddsOtherItemsAndKeepsTheCountOfFurtherSteps) {
  Work items, others, step;
  items.add(WorkKind::kRuns, 10, 3);
  others.add(WorkKind::kRuns, 5, 3);
  step.add(WorkKind::kRuns, 12, 100);
  step.add(WorkKind::kVoxels, 7, 1);
  items += others;
  EXPECT_EQ(items.count(WorkKind::kRuns), 15);
  items.then(step);
  EXPECT_EQ(items.count(WorkKind::kRuns), 15);
  EXPECT_EQ(items.count(WorkKind::kVoxels), 7);
  EXPECT_EQ(items.units(), 45 + 1200 + 7);
  items.limit(WorkKind::kRuns, 4);
  EXPECT_EQ(items.largest(), "4 runs");
}

/// An atlas of nested and overlapping structures with grey values: several steps need the same items.
std::shared_ptr<const Atlas> overlapping_atlas(bool compact) {
  TestVolume volume;
  volume.grid.size = {24, 20, 16};
  volume.structures.push_back({"block", box_mask(volume.grid.size, {2, 2, 2}, {20, 17, 13})});
  volume.structures.push_back({"inner", box_mask(volume.grid.size, {4, 5, 4}, {18, 12, 9})});
  volume.structures.push_back({"other", box_mask(volume.grid.size, {10, 1, 3}, {22, 10, 11})});
  volume.values = VoxelBuffer{VoxelType::kUInt8, std::vector<std::byte>(24 * 20 * 16, std::byte{5})};
  return Atlas::open_bytes(
             encode_atlas(fitted(make_content(volume)), {.compact = compact, .threads = 1}).value())
      .value();
}

std::uint64_t all_triangles(const Atlas& atlas) {
  std::uint64_t triangles = 0;
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s) triangles += atlas.triangles(s);
  return triangles;
}

/// Refusals name quantities of the file: no item counts twice, whatever is done with it.
TEST(WorkBudget, CountsEachItemOnce) {
  for (const bool compact : {false, true}) {
    const auto atlas = overlapping_atlas(compact);
    const auto voxels = static_cast<double>(atlas->grid().voxels());
    const auto triangles = static_cast<double>(all_triangles(*atlas));
    const auto runs = [&](Axis axis) { return static_cast<double>(atlas->runs(axis)); };

    const Work verify = atlas->work_of_verify(), all = atlas->work_of_all();
    for (const Work& work : {verify, all}) {
      EXPECT_EQ(work.count(WorkKind::kVoxels), voxels);
      EXPECT_EQ(work.count(WorkKind::kTriangles), triangles);
    }
    EXPECT_EQ(verify.count(WorkKind::kRuns), std::max({runs(Axis::kX), runs(Axis::kY), runs(Axis::kZ)}));
    EXPECT_EQ(all.count(WorkKind::kRuns), runs(Axis::kZ));

    const std::vector<StructureIndex> structures{0, 1, 2};
    const Work surfaces = atlas->work_of_surfaces(structures);
    EXPECT_EQ(surfaces.count(WorkKind::kTriangles), triangles);
    EXPECT_LE(surfaces.count(WorkKind::kRuns), runs(Axis::kZ));
    EXPECT_TRUE(atlas->verify());
    EXPECT_LE(surfaces.count(WorkKind::kBytes), verify.count(WorkKind::kBytes));

    std::vector<ClassId> classes;
    double of_classes = 0;
    for (ClassId c = 1; c < atlas->classes().size(); ++c) {
      classes.push_back(c);
      of_classes += static_cast<double>(atlas->classes().voxels(c));
    }
    const Work normals = atlas->work_of_normals(classes);
    EXPECT_LE(normals.count(WorkKind::kVoxels), of_classes);
    EXPECT_LE(normals.count(WorkKind::kRuns), runs(Axis::kZ));
    for (const Axis axis : kAxes) {
      const Work work = atlas->work_of_runs(classes, axis);
      EXPECT_LE(work.count(WorkKind::kVoxels), of_classes);
      EXPECT_LE(work.count(WorkKind::kRuns), std::max(runs(axis), runs(Axis::kZ)));
    }
  }
}

TEST(WorkBudget, CountsTrianglesOfSparseSurfacesOnce) {
  const auto atlas =
      Atlas::open_bytes(sparse_atlas({100, 100, 100}, {{voxel_box({0, 0, 0}), voxel_box({99, 99, 99})}}))
          .value();
  const StructureIndex first = 0;
  EXPECT_EQ(atlas->work_of_surfaces({&first, 1}).largest(), "16 triangles");
}

/// A class of two voxels has at most two runs, however many the axis has.
TEST(WorkBudget, ChargesDerivedRunsByVoxels) {
  const auto derived = [](std::int64_t others) {
    TestVolume volume;
    volume.grid.size = {40, 8, 8};
    volume.structures.push_back({"two", box_mask(volume.grid.size, {0, 0, 0}, {1, 0, 0})});
    volume.structures.push_back({"others", make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
                                   return i > 3 && i < others && (i + j + k) % 2 == 0;
                                 })});
    AtlasContent content = make_content(volume);
    return Atlas::open_bytes(encode_atlas(content, {.compact = true, .threads = 1}).value()).value();
  };
  const auto units = [](const Atlas& atlas) {
    ClassId of_two = 1;
    while (atlas.classes().voxels(of_two) != 2) ++of_two;
    return atlas.work_of_runs({&of_two, 1}, Axis::kX).units() -
           atlas.work_of_runs({&of_two, 1}, Axis::kZ).units();
  };
  const auto few = derived(6), many = derived(40);
  EXPECT_GT(many->runs(Axis::kX), few->runs(Axis::kX) + 100);
  EXPECT_EQ(units(*many), units(*few));
}

/// Estimates bound what is decoded.
RC_GTEST_PROP(WorkBudget, BoundsDecodedBytes, ()) {
  auto random = *random_source();
  const AtlasContent content = fitted(random_content(random, {9, 7, 30}));
  const auto atlas =
      *Atlas::open_bytes(*encode_atlas(content, {.compact = below(2, random) == 1, .threads = 1}));
  double estimate = 0;
  const auto charged = [&](const Work& work) {
    estimate += work.units();
    return true;
  };
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    for (const Axis axis : kAxes)
      RC_ASSERT(charged(atlas->work_of_runs({&c, 1}, axis)) && atlas->read_runs(c, axis));
    RC_ASSERT(charged(atlas->work_of_values({&c, 1})) && atlas->read_values(c));
    RC_ASSERT(charged(atlas->work_of_normals({&c, 1})) && atlas->read_normals(c));
  }
  for (StructureIndex s = 0; s < content.graph.size(); ++s)
    RC_ASSERT(charged(atlas->work_of_surfaces({&s, 1})) && atlas->read_surface(s));
  RC_ASSERT(4 * static_cast<double>(atlas->counters().decoded) <= estimate);
}

/// Two voxels, whatever the distance: the work of their surface does not grow.
TEST(WorkBudget, FollowsTheContentOfSparseGrids) {
  double latest = 0;
  for (const std::int64_t side : {100, 1000, 10000}) {
    const auto atlas =
        Atlas::open_bytes(sparse_atlas({side, side, side},
                                       {{voxel_box({0, 0, 0}), voxel_box({side - 1, side - 1, side - 1})}}))
            .value();
    const double units = atlas->work_of_verify().units();
    if (latest > 0) {
      EXPECT_NEAR(units, latest, 100);
    }
    latest = units;
    EXPECT_TRUE(atlas->verify());
    EXPECT_EQ(atlas->read_surface(0).value().triangles.size(), 16u);
  }
  EXPECT_LT(latest, 1e5);
}

/// A file of a few hundred bytes: a volume of all voxels would take a TiB.
TEST(WorkBudget, RefusesVolumesOfSparseGrids) {
  const auto bytes =
      sparse_atlas({8192, 8192, 8192}, {{voxel_box({0, 0, 0}), voxel_box({8191, 8191, 8191})}});
  EXPECT_LT(bytes.size(), 1000u);
  const auto atlas = Atlas::open_bytes(bytes, "cube").value();
  for (const auto& refused : {atlas->read_classes(), atlas->read_all()})
    EXPECT_THAT(refused,
                FailsWith(ErrorCode::kLimit, AllOf(HasSubstr("cube: reading"), HasSubstr("--max-work"))));
  EXPECT_EQ(atlas->counters().decoded, 0u);
}

/// A class with too many runs never makes another one fail, even while its own reading fails.
TEST(WorkBudget, OnlyClassesWithTooManyRunsFail) {
  std::vector<SparseStructure> structures(1);
  for (std::int64_t j = 0; j < 300; ++j) structures[0].push_back(voxel_box({0, 3 * j, 0}));
  for (std::int64_t j = 0; j < 200; ++j) structures.push_back({voxel_box({5, 3 * j, 0})});
  AtlasParts parts = take_apart(sparse_atlas({10, 900, 3}, structures));
  parts.directory.run_totals[2] = 200;
  const Bytes bytes = put_together(parts);
  for (int round = 0; round < 30; ++round) {
    const auto atlas = Atlas::open_bytes(bytes).value();
    std::atomic<bool> done = false;
    std::thread failing([&] {
      while (!done) EXPECT_FALSE(atlas->read_runs(1, Axis::kZ));
    });
    for (ClassId c = 2; c < atlas->classes().size(); ++c) EXPECT_TRUE(atlas->read_runs(c, Axis::kZ)) << c;
    done = true;
    failing.join();
  }
}

/// More runs than the directory states are refused while reading, in any order.
TEST(WorkBudget, RunsAreCounted) {
  const AtlasContent content = fitted(random_content(3));
  const auto atlas = Atlas::open_bytes(encode_atlas(content).value()).value();
  for (int repeat = 0; repeat < 3; ++repeat) {  // a class counts once
    for (ClassId c = 0; c < content.classes.size(); ++c) EXPECT_TRUE(atlas->read_runs(c, Axis::kX));
  }
}

}  // namespace
}  // namespace splatlas
