#include <tuple>

#include <gtest/gtest.h>

#include "player/render/decode/class_cache.h"

namespace splatlas {
namespace {

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

}  // namespace
}  // namespace splatlas
