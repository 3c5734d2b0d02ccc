#include "format/tasks/work_budget.h"

#include <atomic>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/tasks/task_control.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/support/fails_with.h"
#include "tests/support/fit_parts.h"
#include "tests/support/sparse_atlas.h"

namespace splatlas {
namespace {

using ::testing::EndsWith;

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

TEST(WorkBudget, GrowsWithTheFile) {
  EXPECT_EQ(WorkBudget("F", 100, 1, kGiB).cpu_seconds(), 30);
  EXPECT_EQ(WorkBudget("F", 1 << 20, 1, kGiB).cpu_seconds(), 30);
  EXPECT_DOUBLE_EQ(WorkBudget("F", (1 << 20) + 5, 1, kGiB).cpu_seconds(), 30 + 5e-5);
  EXPECT_EQ(WorkBudget("F", 100, 2.5, kGiB).cpu_seconds(), 75);
  EXPECT_EQ(WorkBudget("F", 100, std::nan(""), kGiB).cpu_seconds(), 30);
}

TEST(WorkBudget, HoldsHalfOfTheMachineAtMost) {
  EXPECT_EQ(WorkBudget("F", 100, 1, 16 * kGiB).memory_bytes(), 0x1p31);
  EXPECT_EQ(WorkBudget("F", (1 << 20) + 1024, 1, 16 * kGiB).memory_bytes(), 0x1p31 + 0x1p21);
  EXPECT_EQ(WorkBudget("F", kGiB, 1, 16 * kGiB).memory_bytes(), 0x1p33);
  EXPECT_EQ(WorkBudget("F", 100, 1, 3 * kGiB).memory_bytes(), 1.5 * 0x1p30);
  EXPECT_EQ(WorkBudget("F", 100, 2, 3 * kGiB).memory_bytes(), 3 * 0x1p30);
  EXPECT_EQ(WorkBudget("F", 100, 0.5, 3 * kGiB).memory_bytes(), 0x1p30);
  EXPECT_EQ(WorkBudget("F", 100, 0.01, 3 * kGiB).memory_bytes(), 0x1p29);
}

TEST(WorkBudget, NamesNumbersAndOption) {
  const WorkBudget budget("a.atlas", 21234, 0.5, 2 * kGiB);
  EXPECT_EQ(budget.time_exceeded().code, ErrorCode::kLimit);
  EXPECT_EQ(budget.time_exceeded().message,
            "a.atlas: takes more than 15 s of CPU time, the limit of a file of 21234 bytes. If you trust the "
            "file, allow it with --max-work 5");
  EXPECT_EQ(
      budget.memory_exceeded(0x1p31).message,
      "a.atlas: takes 2048 MiB of memory at once; the limit of a file of 21234 bytes is 1024 MiB. If you "
      "trust the file, allow it with --max-work 1");
  EXPECT_THAT(budget.memory_exceeded(0x1p31 + 1).message, EndsWith("--max-work 2"));
}

/// Sections of unknown kinds cost nothing, so they allow nothing.
TEST(WorkBudget, UnknownSectionsBuyNothing) {
  AtlasParts parts = take_apart(encode_atlas(fitted(random_content(3))).value());
  const double before = Atlas::open_bytes(put_together(parts)).value()->work_budget().cpu_seconds();
  parts.chunks.insert(parts.chunks.begin(), Bytes(4 << 20));
  const auto& padding = parts.chunks.front();
  parts.directory.sections.insert(parts.directory.sections.begin(), {4711, 1, 5, 7});
  parts.directory.chunks.insert(
      parts.directory.chunks.begin(),
      {checksum_of(padding), static_cast<std::uint32_t>(padding.size()), ChunkCodec::kStored, 0});
  EXPECT_EQ(Atlas::open_bytes(put_together(parts)).value()->work_budget().cpu_seconds(), before);
}

/// Two voxels, whatever the distance: nothing takes memory by the voxel of the grid.
TEST(WorkBudget, FollowsTheContentOfSparseGrids) {
  for (const std::int64_t side : {100, 1000, 10000}) {
    const auto file =
        sparse_atlas({side, side, side}, {{voxel_box({0, 0, 0}), voxel_box({side - 1, side - 1, side - 1})}});
    const auto atlas = Atlas::open_bytes(file, "F", {.memory_bytes = 4 << 20}).value();
    EXPECT_TRUE(atlas->verify());
    EXPECT_EQ(atlas->read_surface(0).value().triangles.size(), 16u);
  }
}

/// A file of a few hundred bytes: a volume of all voxels would take a TiB.
TEST(WorkBudget, RefusesVolumesOfSparseGrids) {
  const auto bytes =
      sparse_atlas({8192, 8192, 8192}, {{voxel_box({0, 0, 0}), voxel_box({8191, 8191, 8191})}});
  EXPECT_LT(bytes.size(), 1000u);
  const auto atlas = Atlas::open_bytes(bytes, "cube").value();
  for (const auto& refused : {atlas->read_classes(), atlas->read_all()})
    EXPECT_THAT(refused, FailsWith(ErrorCode::kLimit,
                                   AllOf(HasSubstr("cube: takes 2097152 MiB"), HasSubstr("--max-work"))));
  EXPECT_EQ(atlas->counters().decoded, 0u);
}

/// A task that the caller began counts the work of the calls in it.
TEST(WorkBudget, CallsCountForTheTaskOfTheirThread) {
  const auto atlas = Atlas::open_bytes(encode_atlas(fitted(random_content(3))).value(), "F").value();
  const WorkBudget nothing("outer", 100, 1, 2);
  const TaskControl task({}, {}, &nothing);
  const auto refused = atlas->read_all();
  EXPECT_THAT(refused, FailsWith(ErrorCode::kLimit, HasSubstr("outer: takes")));
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
