#include "format/codec/value_codec.h"

#include <cstring>
#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/format/random_volume.h"
#include "tests/format/second_reader/plain_codecs.h"

namespace splatlas {
namespace {

constexpr std::size_t kCounts = 64;  // bytes of the bucket counts
constexpr std::size_t kHeader = 80;  // bytes of the other header fields

/// A fully covered box.
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

std::uint32_t count_at(const std::vector<std::byte>& code, std::size_t bucket) {
  std::uint32_t count = 0;
  std::memcpy(&count, &code[4 * bucket], sizeof count);
  return count;
}

TEST(ValueCodec, TheFirstVoxelsByHand) {
  // 10 (residual 10, code 20), then 12 (2, code 4), then 11 (-1, code 1). Without neighbours above or behind,
  // errors of 8 * 4 use bucket 11. Their mean of 13 / 3 is shifted by one.
  const Block block({3, 1, 1});
  const auto code =
      encode_values(block.voxels, VoxelType::kUInt8, bytes_of_values<std::uint8_t>({10, 12, 11}));
  std::vector<std::byte> expected(kHeader + 3);
  expected[4 * 11] = std::byte{3};
  std::memcpy(&expected[kCounts], kMeanWeights.data(), kMeanWeights.size());
  expected[kHeader - 2] = std::byte{1};
  expected[kHeader] = std::byte{20};
  expected[kHeader + 1] = std::byte{4};
  expected[kHeader + 2] = std::byte{1};
  EXPECT_EQ(code, expected);
  // Signed values count from the minimum of their type.
  const auto signed_code =
      encode_values(block.voxels, VoxelType::kInt8, bytes_of_values<std::int8_t>({-118, -116, -117}));
  EXPECT_EQ(signed_code, expected);
}

std::vector<std::byte> random_values(std::mt19937& random, std::size_t voxels) {
  const unsigned range = 1 + random() % 256;
  std::vector<std::byte> values(voxels);
  for (std::byte& value : values) value = static_cast<std::byte>(random() % range);
  return values;
}

Index3 random_size(std::mt19937& random) {
  return {1 + static_cast<std::int64_t>(random() % 70), 1 + static_cast<std::int64_t>(random() % 6),
          1 + static_cast<std::int64_t>(random() % 6)};
}

/// The values of a code of a block, by the decoder of the second reader.
std::vector<std::byte> decoded_plainly(const Block& block, const std::vector<std::byte>& code) {
  std::vector<std::size_t> voxels(block.voxels.voxels);
  std::iota(voxels.begin(), voxels.end(), std::size_t{0});
  return second::decode_predicted(code, voxels, block.size, static_cast<std::uint8_t>(VoxelType::kUInt8));
}

RC_GTEST_PROP(ValueCodec, CodesAsTheDocumentSays, ()) {
  auto random = *random_source();
  const Block block(random_size(random));
  const std::vector<std::byte> values = random_values(random, block.voxels.voxels);
  RC_ASSERT(decoded_plainly(block, encode_values(block.voxels, VoxelType::kUInt8, values)) == values);
}

/// Sums wrap around at 16 bits, without effect on the bits that predictions use. Errors are shifted away, so
/// that buckets depend on the places of voxels alone, as for values of 0.
RC_GTEST_PROP(ValueCodec, DecodesAnyWeights, ()) {
  auto random = *random_source();
  const Block block(random_size(random));
  auto code = encode_values(block.voxels, VoxelType::kUInt8, std::vector<std::byte>(block.voxels.voxels));
  const auto kind = random() % 3;
  for (std::size_t n = 0; n < 14; ++n)
    code[kCounts + n] = static_cast<std::byte>(kind == 0 ? 0x80 : kind == 1 ? 0x7f : random());
  code[kHeader - 2] = std::byte{15};
  for (std::size_t n = kHeader; n < code.size(); ++n) code[n] = static_cast<std::byte>(random());
  RC_ASSERT(decode_values(block.voxels, VoxelType::kUInt8, code).value() == decoded_plainly(block, code));
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

TEST(ValueCodec, RefusesSpansThatDoNotFitTheBox) {
  const Block block({4, 3, 3});
  std::vector<std::byte> code(kHeader + 36);
  const auto refusal = [&](const GroupVoxels& voxels) {
    const auto decoded = decode_values(voxels, VoxelType::kUInt8, code);
    return decoded ? std::string() : decoded.error().message;
  };
  code[0] = std::byte{36};
  GroupVoxels smaller = block.voxels;
  for (std::size_t a = 0; a < 3; ++a) {
    smaller.box = block.voxels.box;
    --smaller.box.last[a];
    EXPECT_EQ(refusal(smaller), "runs do not match the box");
    smaller.box = block.voxels.box;
    ++smaller.box.first[a];
    EXPECT_EQ(refusal(smaller), "runs do not match the box");
  }
  smaller = block.voxels;
  ++smaller.voxels;
  EXPECT_EQ(refusal(smaller), "runs do not match the box");
}

TEST(ValueCodec, ErrorsOfNoiseAreShiftedIntoTheBuckets) {
  // 16-bit noise of +-1000: without the shift, nearly all voxels would use the last bucket.
  std::mt19937 random(5);
  const Block block({40, 20, 20});
  std::vector<std::int16_t> values(block.voxels.voxels);
  for (std::int16_t& value : values) value = static_cast<std::int16_t>(random() % 2001 - 1000);
  const auto code = encode_values(block.voxels, VoxelType::kInt16, bytes_of_values(values));
  EXPECT_GE(code[kHeader - 2], std::byte{6});
  EXPECT_LE(count_at(code, 15), 1600u);
  EXPECT_EQ(*decode_values(block.voxels, VoxelType::kInt16, code), bytes_of_values(values));
}

TEST(ValueCodec, PredictsIntegersWhoseSlicesFitInMemory) {
  const IndexBox box{{0, 0, 0}, {4093, 4092, 9}}, larger{{0, 0, 0}, {4094, 4092, 9}};
  EXPECT_TRUE(predicts_values(VoxelType::kUInt8, box, 5));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, larger, 5));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, box, 0));
  EXPECT_FALSE(predicts_values(VoxelType::kUInt8, box, std::uint64_t{1} << 32));
  EXPECT_FALSE(predicts_values(VoxelType::kFloat32, box, 5));
  EXPECT_EQ(value_code_bytes(VoxelType::kInt16, box, 5), kHeader + 10);
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
  const auto has_values = [](const AtlasContent& c) { return !c.values.empty() && c.classes.size() >= 6; };
  const AtlasContent content = random_content_with(has_values, 7, {12, 6, 5});
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
