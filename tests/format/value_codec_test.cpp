#include "format/value_codec.h"

#include <cstring>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kCounts = 64;  // bytes of the buckets' counts

/// All voxels of a box of its own.
struct Block {
  Index3 size;
  std::vector<ClassSpan> spans;
  GroupVoxels voxels;

  explicit Block(const Index3& of) : size(of) {
    for (std::int64_t line = 0; line < size[1] * size[2]; ++line) {
      spans.push_back({{static_cast<std::uint64_t>(line), 0, static_cast<std::uint32_t>(size[0])}, 1});
    }
    voxels = {spans,
              static_cast<std::uint64_t>(size[0] * size[1] * size[2]),
              {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}},
              size[1]};
  }
};

template <typename T>
std::vector<std::byte> bytes_of_values(const std::vector<T>& values) {
  const auto raw = std::as_bytes(std::span(values));
  return {raw.begin(), raw.end()};
}

TEST(ValueCodec, ARampIsPredictedExactly) {
  const Block block({8, 7, 6});
  std::vector<std::uint8_t> values;
  for (int n = 0; n < 8 * 7 * 6; ++n)
    values.push_back(static_cast<std::uint8_t>(20 + n % 8 + n / 8 % 7 * 2 + n / 56));
  const auto code = encode_values(block.voxels, VoxelType::kUInt8, bytes_of_values(values));
  ASSERT_EQ(code.size(), value_code_bytes(VoxelType::kUInt8, block.voxels.box, values.size()));
  ASSERT_EQ(code.size(), kCounts + values.size());
  // The first voxel has nothing before it, and the borders are made up; inside all is a plane.
  const auto wrong =
      std::count_if(code.begin() + kCounts, code.end(), [](std::byte b) { return b != std::byte{0}; });
  EXPECT_LE(wrong, 8 * 7 * 6 - 7 * 6 * 5);
  EXPECT_EQ(*decode_values(block.voxels, VoxelType::kUInt8, code), bytes_of_values(values));
}

TEST(ValueCodec, TheFirstVoxelsByHand) {
  // 10, then predicted by its neighbour along i: 12 is 2 more (code 4), 11 is 1 less (code 1).
  const Block block({3, 1, 1});
  const auto code =
      encode_values(block.voxels, VoxelType::kUInt8, bytes_of_values<std::uint8_t>({10, 12, 11}));
  std::vector<std::byte> expected(kCounts + 3);
  expected[0] = std::byte{2};       // in bucket 0: nothing around differs
  expected[15 * 4] = std::byte{1};  // in the last bucket: nothing is around
  expected[kCounts] = std::byte{4};
  expected[kCounts + 1] = std::byte{1};
  expected[kCounts + 2] = std::byte{20};
  EXPECT_EQ(code, expected);
  // Signed values count from their least.
  const auto signed_code =
      encode_values(block.voxels, VoxelType::kInt8, bytes_of_values<std::int8_t>({-118, -116, -117}));
  EXPECT_EQ(signed_code, expected);
}

RC_GTEST_PROP(ValueCodec, DecodesWhatWasEncodedOfEveryType, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {10, 5, 10});
  const Index3 size = storage_grid(content).size;
  const RunModel model = encode_runs(content.class_volume, size, Axis::kZ, content.classes.size());
  const ValueGroups groups(content.classes);
  std::uint64_t voxels_of_all = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<ClassRuns> runs;
    for (const ClassId c : groups.classes[g]) runs.push_back(model.classes[c]);
    std::vector<ClassSpan> spans = merge_runs(groups.classes[g], runs);
    if (g == 0) {
      std::vector<ClassId> all(content.classes.size());
      std::iota(all.begin(), all.end(), ClassId{0});
      spans = gaps_between(merge_runs(all, model.classes), size);
    }
    const GroupVoxels voxels{spans, group_voxels(groups, content.classes, g),
                             group_box(groups, content.classes, g, size), size[1]};
    std::uint64_t counted = 0, last = 0;
    for (const ClassSpan& span : spans) {
      const std::uint64_t at = span.run.scanline * static_cast<std::uint64_t>(size[0]) + span.run.start;
      RC_ASSERT(counted == 0 || at >= last);  // in memory order, apart
      last = at + span.run.length;
      counted += span.run.length;
      for (std::uint64_t v = at; v < last; ++v) RC_ASSERT(content.class_volume[v] == span.of);
    }
    RC_ASSERT(counted == voxels.voxels);
    voxels_of_all += counted;
    for (const VoxelType type : {VoxelType::kUInt8, VoxelType::kInt8, VoxelType::kUInt16, VoxelType::kInt16,
                                 VoxelType::kInt32, VoxelType::kFloat64}) {
      std::vector<std::byte> values(counted * bytes_of(type));
      const bool noise = random() % 2 == 0;
      for (std::byte& b : values) b = static_cast<std::byte>(noise ? random() : random() % 3);
      const auto code = encode_values(voxels, type, values);
      RC_ASSERT(code.size() == value_code_bytes(type, voxels.box, counted));
      RC_ASSERT(decode_values(voxels, type, code).value() == values);
    }
  }
  RC_ASSERT(voxels_of_all == content.class_volume.size());
}

RC_GTEST_PROP(ValueCodec, AnyBytesDecodeOrAreRefused, ()) {
  auto random = *random_source();
  const Block block({4, 3, 3});
  std::vector<std::byte> code(kCounts + 2 * 36);
  for (std::size_t n = kCounts; n < code.size(); ++n) code[n] = static_cast<std::byte>(random());
  std::uint32_t left = 36;
  for (std::size_t b = 0; b < 16; ++b) {
    const auto count = b == 15 ? left : static_cast<std::uint32_t>(random() % (left + 1));
    std::memcpy(&code[4 * b], &count, 4);
    left -= count;
  }
  const auto decoded = decode_values(block.voxels, VoxelType::kUInt16, code);
  if (decoded) {
    RC_ASSERT(encode_values(block.voxels, VoxelType::kUInt16, *decoded) == code);
  } else {
    RC_ASSERT(decoded.error().code == ErrorCode::kInvalidAtlas);
  }
}

TEST(ValueCodec, RefusesCountsAndSpansThatDoNotFit) {
  const Block block({4, 3, 3});
  std::vector<std::byte> code(kCounts + 36);
  const auto refusal = [&](const GroupVoxels& voxels) {
    const auto decoded = decode_values(voxels, VoxelType::kUInt8, code);
    return decoded ? std::string() : decoded.error().message;
  };
  EXPECT_EQ(refusal(block.voxels), "buckets hold less than the voxels");
  code[0] = std::byte{37};
  EXPECT_EQ(refusal(block.voxels), "buckets hold more than the voxels");
  code[0] = std::byte{36};
  EXPECT_EQ(refusal(block.voxels), "buckets do not hold what the voxels call for");
  GroupVoxels smaller = block.voxels;
  for (std::size_t a = 0; a < 3; ++a) {
    smaller.box = block.voxels.box;
    --smaller.box.last[a];
    EXPECT_EQ(refusal(smaller), "boxes are not those of the runs");
    smaller.box = block.voxels.box;
    ++smaller.box.first[a];
    EXPECT_EQ(refusal(smaller), "boxes are not those of the runs");
  }
  smaller = block.voxels;
  ++smaller.voxels;
  EXPECT_EQ(refusal(smaller), "boxes are not those of the runs");
}

TEST(ValueCodec, PredictsIntegersWhoseSlicesFitInMemory) {
  const IndexBox box{{0, 0, 0}, {4093, 4093, 9}}, larger{{0, 0, 0}, {4094, 4093, 9}};
  EXPECT_TRUE(predicts_values(VoxelType::kUInt8, box, 5));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, larger, 5));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, box, 0));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, box, std::uint64_t{1} << 32));
  EXPECT_FALSE(predicts_values(VoxelType::kFloat32, box, 5));
  EXPECT_EQ(value_code_bytes(VoxelType::kInt16, box, 5), kCounts + 10);
  EXPECT_EQ(value_code_bytes(VoxelType::kInt16, larger, 5), 10u);
}

TEST(ValueGroups, HoldClassesThatDifferInTheirPartsOnly) {
  ClassTable table;
  table.intern({{0, Part::kInterior}});
  table.intern({{0, Part::kInterior}, {1, Part::kBoundary}});
  table.intern({{0, Part::kBoundary}});
  table.intern({{0, Part::kBoundary}, {1, Part::kCrossed}});
  table.intern({{1, Part::kCrossed}});
  const ValueGroups groups(table);
  EXPECT_EQ(groups.classes, (std::vector<std::vector<ClassId>>{{0}, {1, 3}, {2}, {4}, {5}}));
  EXPECT_EQ(groups.group_of, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 4}));
}

TEST(ReadValues, GivesEveryClassItsOwnInAnyOrderAndAgain) {
  std::mt19937 random(7);
  AtlasContent content;
  do content = random_content(random, {12, 6, 5});
  while (content.values.empty() || content.classes.size() < 6);
  const auto atlas = *Atlas::open_bytes(*encode_atlas(content, {.threads = 1}));
  const std::size_t value_bytes = bytes_of(content.values.type);
  std::vector<std::vector<std::byte>> expected(content.classes.size());
  for (std::size_t v = 0; v < content.class_volume.size(); ++v) {
    const std::byte* const value = &content.values.bytes[v * value_bytes];
    auto& of = expected[content.class_volume[v]];
    of.insert(of.end(), value, value + value_bytes);
  }
  for (int turn = 0; turn < 3; ++turn) {
    for (std::size_t n = 0; n < expected.size(); ++n) {
      const auto c = static_cast<ClassId>(turn == 1 ? expected.size() - 1 - n : n);
      EXPECT_EQ(*atlas->read_values(c), expected[c]);
      if (turn == 2) {
        EXPECT_EQ(*atlas->read_values(c), expected[c]);
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
