#include "format/content/run_model.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// Brute force: the runs of every scanline, voxel by voxel.
RunModel encode_slowly(const std::vector<ClassId>& volume, const Index3& size, Axis axis,
                       std::size_t classes) {
  RunModel model{axis, std::vector<ClassRuns>(classes)};
  const ScanOrder order = ScanOrder::of(axis);
  std::uint64_t scanline = 0;
  for (std::int64_t slice = 0; slice < size[order.slice_axis]; ++slice) {
    for (std::int64_t row = 0; row < size[order.row_axis]; ++row, ++scanline) {
      ClassId before = kEmptyClass;
      for (std::int64_t n = 0; n < size[order.scan_axis]; ++n) {
        Index3 at{};
        at[order.slice_axis] = slice;
        at[order.row_axis] = row;
        at[order.scan_axis] = n;
        const ClassId c = volume[static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0])];
        if (c != kEmptyClass && c == before) ++model.classes[c].back().length;
        if (c != kEmptyClass && c != before) {
          model.classes[c].push_back({scanline, static_cast<std::uint32_t>(n), 1});
        }
        before = c;
      }
    }
  }
  return model;
}

RC_GTEST_PROP(RunModel, EncodesLikeBruteForce, ()) {
  const auto v = *random_class_volume();
  for (const Axis axis : kAxes) {
    RC_ASSERT(encode_runs(v.classes, v.size, axis, v.class_count) ==
              encode_slowly(v.classes, v.size, axis, v.class_count));
  }
}

RC_GTEST_PROP(RunModel, DecodesToTheVolume, ()) {
  const auto v = *random_class_volume();
  for (const Axis axis : kAxes) {
    const auto decoded = decode_runs(encode_runs(v.classes, v.size, axis, v.class_count), v.size);
    RC_ASSERT(decoded.has_value());
    RC_ASSERT(*decoded == v.classes);
  }
}

RC_GTEST_PROP(RunModel, RunsAreValidAndCountTheVoxels, ()) {
  const auto v = *random_class_volume();
  std::vector<std::uint64_t> voxels(v.class_count);
  for (const ClassId c : v.classes) ++voxels[c];
  for (const Axis axis : kAxes) {
    const RunModel model = encode_runs(v.classes, v.size, axis, v.class_count);
    for (ClassId c = 1; c < v.class_count; ++c) {
      RC_ASSERT(validate_runs(model.classes[c], v.size, axis, voxels[c]).has_value());
      RC_ASSERT(!validate_runs(model.classes[c], v.size, axis, voxels[c] + 1).has_value());
    }
    RC_ASSERT(model.classes[kEmptyClass].empty());
  }
}

RC_GTEST_PROP(RunModel, ConvertsBetweenAllAxes, ()) {
  const auto v = *random_class_volume();
  for (const Axis from : kAxes) {
    const RunModel source = encode_runs(v.classes, v.size, from, v.class_count);
    for (const Axis to : kAxes) {
      const RunModel target = encode_runs(v.classes, v.size, to, v.class_count);
      for (ClassId c = 0; c < v.class_count; ++c) {
        RC_ASSERT(convert_runs(source.classes[c], v.size, from, to) == target.classes[c]);
      }
    }
  }
}

TEST(RunModel, ConvertsRunsThatLieFarApart) {
  constexpr std::uint32_t kLength = 1u << 20u;
  constexpr std::uint64_t kLast = kLength - 1;
  const Index3 size{kLength, 3, 5};
  const ClassRuns z{{0, 0, 1}, {2, 7, 2}, {14, kLength - 2, 2}};
  const ClassRuns x{{0, 0, 1}, {35, 2, 1}, {40, 2, 1}, {(kLast - 1) * 5 + 4, 2, 1}, {kLast * 5 + 4, 2, 1}};
  EXPECT_EQ(convert_runs(z, size, Axis::kZ, Axis::kX), x);
  EXPECT_EQ(convert_runs(x, size, Axis::kX, Axis::kZ), z);
  EXPECT_EQ(convert_runs(x, size, Axis::kX, Axis::kY), convert_runs(z, size, Axis::kZ, Axis::kY));
}

constexpr Index3 kSize{4, 3, 2};

std::uint64_t voxels_of(const ClassRuns& runs) {
  std::uint64_t sum = 0;
  for (const Run& run : runs) sum += run.length;
  return sum;
}

TEST(ValidateRuns, TakesMaximalRunsInOrder) {
  const ClassRuns runs{{0, 0, 2}, {0, 3, 1}, {1, 0, 4}, {5, 3, 1}};
  EXPECT_TRUE(validate_runs(runs, kSize, Axis::kZ, 8));
  EXPECT_TRUE(validate_runs({}, kSize, Axis::kX, 0));
}

TEST(DecodeRuns, RefusesEachFault) {
  const std::vector<std::pair<const char*, std::vector<ClassRuns>>> faults{
      {"outside", {{}, {{0, 3, 2}}}},
      {"empty run", {{}, {{0, 3, 0}}}},
      {"out of order", {{}, {{1, 0, 1}, {0, 0, 1}}}},
      {"overlap of two classes", {{}, {{0, 0, 2}}, {{0, 1, 1}}}},
      {"overlap of one class", {{}, {{0, 0, 2}, {0, 1, 1}}}},
      {"runs of the empty class", {{{0, 0, 1}}}},
  };
  for (const auto& [what, classes] : faults) {
    EXPECT_THAT(decode_runs({Axis::kZ, classes}, kSize), FailsWith(ErrorCode::kInvalidAtlas, testing::_))
        << what;
  }
}

RC_GTEST_PROP(ValidateRuns, NeverTrustsANumber, (const std::vector<std::array<std::uint64_t, 3>>& numbers)) {
  ClassRuns runs;
  for (const auto& [scanline, start, length] : numbers) {
    runs.push_back({scanline, static_cast<std::uint32_t>(start), static_cast<std::uint32_t>(length)});
  }
  for (const Axis axis : kAxes) {
    if (!validate_runs(runs, kSize, axis, voxels_of(runs))) continue;
    RC_ASSERT(decode_runs({axis, {{}, runs}}, kSize).has_value());  // accepted runs must be safe to use
  }
}

}  // namespace
}  // namespace splatlas
