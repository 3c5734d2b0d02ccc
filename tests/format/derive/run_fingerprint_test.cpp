#include "format/derive/run_fingerprint.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

/// The definition, in arbitrary precision of 128 bits: one power per voxel.
std::uint64_t fingerprint_by_definition(const ClassVolume& v, ClassId c) {
  __extension__ using Wide = unsigned __int128;
  constexpr Wide kPrime = (Wide{1} << 61) - 1, kBase = Wide{0x243f6a8885a308d3} % kPrime;
  Wide sum = 0, power = 1;
  for (const ClassId voxel : v.classes) {
    if (voxel == c) sum = (sum + power) % kPrime;
    power = power * kBase % kPrime;
  }
  return static_cast<std::uint64_t>(sum);
}

RC_GTEST_PROP(RunFingerprint, FollowsItsDefinition, ()) {
  const auto v = *random_class_volume();
  const RunFingerprinter fingerprinter(v.size);
  VoxelSetFingerprint sum = fingerprint_by_definition(v, kEmptyClass);
  for (ClassId c = 1; c < v.class_count; ++c) {
    const auto fingerprint = fingerprint_by_definition(v, c);
    for (const Axis axis : kAxes) {
      const RunModel model = encode_runs(v.classes, v.size, axis, v.class_count);
      RC_ASSERT(fingerprinter.of(model.classes[c], axis) == fingerprint);
    }
    RC_ASSERT(is_fingerprint(fingerprint));
    sum = add_fingerprints(sum, fingerprint);
  }
  RC_ASSERT(fingerprinter.of_grid() == sum);
  RC_ASSERT(subtract_fingerprints(sum, fingerprint_by_definition(v, 0)) ==
            subtract_fingerprints(fingerprinter.of_grid(), fingerprint_by_definition(v, 0)));
}

/// Sides beyond the first table of powers.
TEST(RunFingerprint, IsThatOfTheVoxelsOfLongAxes) {
  for (const Index3& size : {Index3{10'000, 2, 1}, Index3{2, 10'000, 1}, Index3{1, 2, 10'000}}) {
    std::vector<ClassId> volume(20'000, 0);
    for (std::size_t n = 0; n < volume.size(); ++n) volume[n] = n % 7 < 3 || n > 15'000 ? 1 : 0;
    const RunFingerprinter fingerprinter(size);
    for (const Axis axis : kAxes) {
      EXPECT_EQ(fingerprinter.of(encode_runs(volume, size, axis, 2).classes[1], axis),
                fingerprint_by_definition({size, 2, volume}, 1));
    }
  }
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
