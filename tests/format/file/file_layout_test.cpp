#include "format/file/file_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/io/checksum.h"
#include "tests/format/random_volume.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

using Bytes = std::vector<std::byte>;
using Positions = std::vector<std::uint64_t>;

Positions cut(const Positions& sizes, std::uint64_t chunk_bytes, std::uint64_t shared_bytes) {
  return cut_streams(begins_of(sizes), chunk_bytes, shared_bytes, 1000).value();
}

TEST(CutStreams, GivesLongStreamsChunksOfTheirOwn) {
  EXPECT_EQ(cut({100, 250}, 100, 10), (Positions{0, 100, 200, 300, 350}));
  EXPECT_EQ(cut({11, 100, 101}, 100, 10), (Positions{0, 11, 111, 211, 212}));
}

TEST(CutStreams, LetsShortNeighboursShareChunks) {
  EXPECT_EQ(cut({4, 4, 2}, 100, 10), (Positions{0, 10}));
  EXPECT_EQ(cut({4, 4, 3}, 100, 10), (Positions{0, 8, 11}));
  EXPECT_EQ(cut({4, 50, 4, 4}, 100, 10), (Positions{0, 4, 54, 62}));
  EXPECT_EQ(cut({10, 10, 10}, 100, 10), (Positions{0, 10, 20, 30}));
  EXPECT_EQ(cut({4, 4, 3}, 100, 0), (Positions{0, 4, 8, 11}));
}

TEST(CutStreams, EmptyStreamsTakeNoChunk) {
  EXPECT_EQ(cut({}, 100, 10), (Positions{0}));
  EXPECT_EQ(cut({0, 0}, 100, 10), (Positions{0}));
  EXPECT_EQ(cut({0, 4, 0, 6, 0}, 100, 10), (Positions{0, 10}));
  EXPECT_EQ(cut({0, 40, 0, 0, 60, 0}, 100, 10), (Positions{0, 40, 100}));
}

TEST(CutStreams, StopsAtTheLimit) {
  const Positions begins = begins_of(Positions{std::uint64_t{1} << 43});  // 2^40 doubles: 2^31 chunks of 4 kB
  EXPECT_EQ(cut_streams(begins, 4096, 0, 100), std::nullopt);
  EXPECT_EQ(cut_streams(begins_of(Positions{8, 8, 8}), 8, 0, 2), std::nullopt);
  EXPECT_EQ(cut_streams(begins_of(Positions{8, 8, 8}), 8, 0, 3), (Positions{0, 8, 16, 24}));
  EXPECT_EQ(cut_streams(begins_of(Positions{8, 1, 1}), 8, 2, 1), std::nullopt);
}

RC_GTEST_PROP(CutStreams, CoversEveryByteOnceAndNeverMixesLongStreams, ()) {
  const auto sizes = *rc::gen::container<Positions>(
      rc::gen::weightedOneOf<std::uint64_t>({{1, rc::gen::just<std::uint64_t>(0)},
                                             {4, uniform<std::uint64_t>(1, 12)},
                                             {1, uniform<std::uint64_t>(13, 300)}}));
  const auto shared = *uniform<std::uint64_t>(0, 16), chunk = *uniform<std::uint64_t>(16, 64);
  const Positions begins = begins_of(sizes), cuts = cut(sizes, chunk, shared);
  RC_ASSERT(cuts.front() == 0u);
  RC_ASSERT(cuts.back() == begins.back());
  for (std::size_t n = 0; n + 1 < cuts.size(); ++n) {
    const std::uint64_t length = cuts[n + 1] - cuts[n];
    RC_ASSERT(length > 0u);
    std::vector<std::uint64_t> touched;  // lengths of the streams in this chunk
    for (std::size_t s = 0; s < sizes.size(); ++s) {
      if (sizes[s] > 0 && begins[s] < cuts[n + 1] && begins[s + 1] > cuts[n]) touched.push_back(sizes[s]);
    }
    if (touched.size() == 1) RC_ASSERT(length <= std::max(chunk, shared));
    if (touched.size() > 1) {
      RC_ASSERT(length <= shared);
      for (const std::uint64_t size : touched) RC_ASSERT(size <= shared);
    }
  }
  // Short streams are never split.
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    if (sizes[s] > shared) continue;
    RC_ASSERT(
        std::ranges::none_of(cuts, [&](std::uint64_t c) { return c > begins[s] && c < begins[s + 1]; }));
  }
}

/// A header and the bytes of a directory only.
struct HeaderTest : ::testing::Test {
  const Bytes directory = Bytes(100, std::byte{1});
  FileHeader header = make_header(directory, 164);
};

TEST_F(HeaderTest, HasTheBytesOfTheFormat) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&header);
  const std::vector<unsigned> expected{0x89, 'S', 'P', 'L', 'A', 'T', 0x0d, 0x0a, 1,   0, 0, 0, 0, 0, 0, 0,
                                       0,    0,   0,   0,   0,   0,   0,    0,    164, 0, 0, 0, 0, 0, 0, 0,
                                       64,   0,   0,   0,   0,   0,   0,    0,    100, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(std::vector<unsigned>(bytes, bytes + 48), expected);
}

/// Refused ahead of allocation, in a file that is large enough.
TEST_F(HeaderTest, LimitsTheDirectory) {
  header.file_bytes = std::uint64_t{1} << 40;
  header.directory_bytes = kMaxDirectoryBytes + 1;
  header.header_checksum = checksum_of(std::as_bytes(std::span(&header, 1)).first(56));
  EXPECT_THAT(check_header(std::as_bytes(std::span(&header, 1)), header.file_bytes),
              FailsWith(ErrorCode::kInvalidAtlas, HasSubstr("limit")));
}

}  // namespace
}  // namespace splatlas
