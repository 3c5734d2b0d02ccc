#include "player/render/decode/scanline_runs.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

constexpr std::int64_t kRows = 7;
constexpr std::int64_t kSlices = 11;
constexpr std::uint32_t kVoxels = 20;  // per scanline

auto in_order(const ClassRun& run) {
  return std::tuple(run.row, run.start, run.length, run.id);
}

/// Classes that partition every scanline.
std::vector<ClassRuns> random_classes(std::mt19937& random) {
  std::vector<ClassRuns> classes(5);
  for (std::uint64_t scanline = 0; scanline < kRows * kSlices; ++scanline) {
    if (random() % 4 == 0) continue;
    for (std::uint32_t at = 0; at < kVoxels;) {
      const auto length = std::min(static_cast<std::uint32_t>(1 + random() % 9), kVoxels - at);
      if (const std::size_t id = random() % (classes.size() + 1); id < classes.size())
        classes[id].push_back({scanline, at, length});
      at += length;
    }
  }
  return classes;
}

TEST(ScanlineRuns, HoldsWhatHasBeenInsertedInOrder) {
  std::mt19937 random(1);
  ThreadPool pool(3);
  for (int n = 0; n < 200; ++n) {
    const std::vector<ClassRuns> classes = random_classes(random);
    std::array<std::vector<ClassRun>, kSlices> expected;
    ScanlineRuns runs;
    for (ClassId next = 0; next < classes.size();) {
      std::vector<std::pair<ClassId, const ClassRuns*>> some;
      for (std::size_t count = random() % 4; count > 0 && next < classes.size(); --count, ++next) {
        some.emplace_back(next, &classes[next]);
        for (const splatlas::Run& run : classes[next]) {
          expected[run.scanline / kRows].push_back(
              {static_cast<std::uint32_t>(run.scanline % kRows), run.start, run.length, next});
        }
      }
      runs.insert(some, kRows, pool);
      for (std::int64_t slice = -1; slice <= kSlices; ++slice) {
        std::vector<ClassRun> of_slice;
        if (slice >= 0 && slice < kSlices) of_slice = expected[static_cast<std::size_t>(slice)];
        std::sort(of_slice.begin(), of_slice.end(),
                  [](const ClassRun& a, const ClassRun& b) { return in_order(a) < in_order(b); });
        const auto held = runs.slice(slice);
        ASSERT_TRUE(
            std::equal(held.begin(), held.end(), of_slice.begin(), of_slice.end(),
                       [](const ClassRun& a, const ClassRun& b) { return in_order(a) == in_order(b); }));
      }
    }
  }
}

/// Rows and starts.
using Places = std::vector<std::tuple<std::uint32_t, std::uint32_t>>;

Places places(const ScanlineRuns& runs, std::int64_t slice) {
  Places found;
  for (const ClassRun& run : runs.slice(slice)) found.emplace_back(run.row, run.start);
  return found;
}

/// Sparse runs are sorted without memory for the gaps.
TEST(ScanlineRuns, RunsMayLieFarApart) {
  constexpr std::uint32_t kFar = 0xfffffff0;
  constexpr std::int64_t kManyRows = std::int64_t{1} << 32;
  const ClassRuns a{{0, kFar, 5}, {kFar, 3, 2}, {(1u << 20) + kManyRows, 4, 2}}, b{{0, 1, 1}, {kFar, 0, 3}};
  ThreadPool pool(2);
  ScanlineRuns runs;
  const std::array<std::pair<ClassId, const ClassRuns*>, 2> both{std::pair{7u, &a}, {9u, &b}};
  runs.insert(both, kManyRows, pool);
  EXPECT_EQ(places(runs, 0), (Places{{0, 1}, {0, kFar}, {kFar, 0}, {kFar, 3}}));
  EXPECT_EQ(places(runs, 1), (Places{{1u << 20, 4}}));
}

/// Only forged files contain these: the kept runs stay sorted.
TEST(ScanlineRuns, OfRunsThatBeginAtOneVoxelOneStays) {
  ThreadPool pool(1);
  for (const std::uint32_t last : {8u, 0xfffffff0u}) {  // near and far apart
    const ClassRuns a{{0, 2, 3}, {1, 5, 1}, {1, last, 1}}, b{{0, 2, 7}, {1, 5, 2}, {1, 6, 1}};
    ScanlineRuns runs;
    const std::array<std::pair<ClassId, const ClassRuns*>, 2> both{std::pair{1u, &a}, {2u, &b}};
    runs.insert(both, 2, pool);
    EXPECT_EQ(places(runs, 0), (Places{{0, 2}, {1, 5}, {1, 6}, {1, last}}));
  }
}

TEST(ScanlineRuns, NothingIsNothing) {
  ThreadPool pool(1);
  ScanlineRuns runs;
  const ClassRuns none;
  const std::pair<ClassId, const ClassRuns*> empty{3, &none};
  runs.insert({&empty, 1}, kRows, pool);
  runs.insert({}, kRows, pool);
  EXPECT_TRUE(runs.slice(0).empty());
}

}  // namespace
}  // namespace splatlas
