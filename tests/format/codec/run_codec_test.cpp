#include "format/codec/run_codec.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

std::vector<std::byte> encode(const ClassRuns& runs) {
  std::vector<std::byte> bytes;
  append_run_list(runs, bytes);
  return bytes;
}

TEST(RunCodec, WritesTheBytesOfTheFormat) {
  // Two scanlines, 300 and 301, of an outline: left and right edge. The second is wider by a voxel each.
  const ClassRuns runs{{300, 10, 2}, {300, 20, 3}, {301, 9, 2}, {301, 21, 3}};
  EXPECT_EQ(encode(runs), bytes_of({
                              4,                    // runs
                              0xac, 0x02, 0, 1, 0,  // scanline steps: 300, 0, 1, 0
                              2, 2, 0, 0,           // lengths: 1 + 1, 2 + 1, 2 + 0, 3 + 0
                              20, 14, 1, 2,         // starts: 0 + 10, 13 + 7, 10 - 1, 20 + 1
                          }));
}

TEST(RunCodec, AnEmptyListTakesNoBytes) {
  EXPECT_TRUE(encode({}).empty());
  EXPECT_EQ(decode_run_list({}, 0).value(), ClassRuns{});
}

RC_GTEST_PROP(RunCodec, DecodesWhatWasEncoded, ()) {
  const auto v = *random_class_volume();
  for (const Axis axis : kAxes) {
    for (const ClassRuns& runs : encode_runs(v.classes, v.size, axis, v.class_count).classes) {
      const std::vector<std::byte> bytes = encode(runs);
      std::uint64_t voxels = 0;
      for (const Run& run : runs) voxels += run.length;
      RC_ASSERT(bytes.size() >= min_run_list_bytes(voxels));
      RC_ASSERT(bytes.size() <= max_run_list_bytes(voxels));
      RC_ASSERT(decode_run_list(bytes, runs.size()).value() == runs);
    }
  }
}

RC_GTEST_PROP(RunCodec, TakesRunsOfAnySize, ()) {
  ClassRuns runs;
  for (std::uint64_t n = *rc::gen::inRange<std::uint64_t>(1, 20); n > 0; --n) {
    runs.push_back({*uniform<std::uint64_t>(0, std::uint64_t{1} << 40), *rc::gen::arbitrary<std::uint32_t>(),
                    *rc::gen::arbitrary<std::uint32_t>()});
  }
  std::ranges::sort(runs, {}, &Run::scanline);
  RC_ASSERT(decode_run_list(encode(runs), runs.size()).value() == runs);
}

RC_GTEST_PROP(RunCodec, RefusesEveryPrefixAndEveryExtraByte, ()) {
  const auto v = *random_class_volume();
  for (const ClassRuns& runs : encode_runs(v.classes, v.size, Axis::kZ, v.class_count).classes) {
    if (runs.empty() || runs.size() > 40) continue;
    std::vector<std::byte> bytes = encode(runs);
    for (std::size_t length = 1; length < bytes.size(); ++length) {
      RC_ASSERT(!decode_run_list(std::span(bytes).first(length), runs.size()));
    }
    bytes.push_back(std::byte{0});
    RC_ASSERT(!decode_run_list(bytes, runs.size()));
  }
}

TEST(RunCodec, AcceptsLongerFormsOfNumbers) {
  // One run: count 1, scanline 0, length 1, start 0.
  const ClassRuns one{{0, 0, 1}};
  EXPECT_EQ(decode_run_list(bytes_of({0x81, 0x00, 0x80, 0x00, 0x80, 0x80, 0x00, 0x00}), 1).value(), one);
  const auto with_scanline_step = [](int length) {  // 0 in `length` bytes
    std::vector<std::byte> bytes = bytes_of({1});
    bytes.insert(bytes.end(), static_cast<std::size_t>(length) - 1, std::byte{0x80});
    bytes.resize(bytes.size() + 3);  // its last byte, the length and the start
    return bytes;
  };
  EXPECT_EQ(decode_run_list(with_scanline_step(10), 1).value(), one);
  EXPECT_FALSE(decode_run_list(with_scanline_step(11), 1));
}

TEST(RunCodec, RefusesNumbersThatWrap) {
  // One run: count, scanline step, length, start. Ten bytes of 0x80 and above exceed 64 bits.
  EXPECT_FALSE(
      decode_run_list(bytes_of({1, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02, 0, 0}), 1));
  // A scanline of 2^49.
  EXPECT_FALSE(decode_run_list(bytes_of({1, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01, 0, 0}), 1));
  // A start of -1.
  EXPECT_FALSE(decode_run_list(bytes_of({1, 0, 0, 1}), 1));
  EXPECT_TRUE(decode_run_list(bytes_of({1, 0, 0, 2}), 1));
  // A start of 2^32.
  EXPECT_FALSE(decode_run_list(bytes_of({1, 0, 0, 0x80, 0x80, 0x80, 0x80, 0x20}), 1));
}

}  // namespace
}  // namespace splatlas
