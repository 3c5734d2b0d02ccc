#include "format/derive/run_fingerprint.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

RC_GTEST_PROP(RunFingerprint, IsThatOfTheVoxelsOnEveryAxis, ()) {
  const auto v = *random_class_volume();
  const RunFingerprinter fingerprinter(v.size);
  std::array<RunModel, 3> models;
  for (const Axis axis : kAxes) {
    models[static_cast<std::size_t>(axis)] = encode_runs(v.classes, v.size, axis, v.class_count);
  }
  for (ClassId c = 1; c < v.class_count; ++c) {
    const auto fingerprint = fingerprinter.of(models[2].classes[c], Axis::kZ);
    RC_ASSERT(fingerprinter.of(models[0].classes[c], Axis::kX) == fingerprint);
    RC_ASSERT(fingerprinter.of(models[1].classes[c], Axis::kY) == fingerprint);
  }
}

RC_GTEST_PROP(RunFingerprint, TellsSetsApartThatDifferInOneVoxel, ()) {
  auto v = *random_class_volume();
  const RunFingerprinter fingerprinter(v.size);
  const ClassId c = 1;
  const std::size_t classes = std::max<std::size_t>(v.class_count, 2);
  const auto before =
      fingerprinter.of(encode_runs(v.classes, v.size, Axis::kX, classes).classes[c], Axis::kX);
  ClassId& voxel = v.classes[*uniform<std::size_t>(0, v.classes.size() - 1)];
  voxel = voxel == c ? kEmptyClass : c;
  const auto after = fingerprinter.of(encode_runs(v.classes, v.size, Axis::kZ, classes).classes[c], Axis::kZ);
  RC_ASSERT(before[0] != after[0]);
  RC_ASSERT(before[1] != after[1]);
}

TEST(RunFingerprint, TellsSetsApartThatDifferInWhereTheyAre) {
  const Index3 size{7, 5, 3};
  const RunFingerprinter fingerprinter(size);
  std::vector<VoxelSetFingerprint> seen;
  for (std::uint64_t scanline = 0; scanline < 15; ++scanline) {
    for (std::uint32_t start = 0; start < 7; ++start) {
      for (std::uint32_t length = 1; start + length <= 7; ++length) {
        seen.push_back(fingerprinter.of(ClassRuns{{scanline, start, length}}, Axis::kZ));
      }
    }
  }
  std::ranges::sort(seen);
  EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end());
}

TEST(RunFingerprint, ReachesTheLastVoxelOfTheLargestGrids) {
  const Index3 size{1 << 14, 1 << 13, 1 << 13};  // 2^40 voxels
  const RunFingerprinter fingerprinter(size);
  const std::uint64_t last = (std::uint64_t{1} << 26) - 1;
  // The last voxel, as a run along each axis.
  const auto z = fingerprinter.of(ClassRuns{{last, (1u << 14) - 1, 1}}, Axis::kZ);
  const auto y = fingerprinter.of(ClassRuns{{last, (1u << 14) - 1, 1}}, Axis::kY);
  const auto x = fingerprinter.of(ClassRuns{{(std::uint64_t{1} << 27) - 1, (1u << 13) - 1, 1}}, Axis::kX);
  EXPECT_EQ(z, y);
  EXPECT_EQ(z, x);
  EXPECT_NE(z, fingerprinter.of(ClassRuns{{last, (1u << 14) - 2, 1}}, Axis::kZ));
}

}  // namespace
}  // namespace splatlas
