#include "format/file/file_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/io/checksum.h"
#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
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

  std::string check(std::uint64_t file_bytes = 164) {
    const auto start = std::as_bytes(std::span(&header, 1));
    const auto checked =
        check_header(start.first(std::min<std::size_t>(file_bytes, sizeof header)), file_bytes);
    if (checked) return "";
    EXPECT_EQ(checked.error().code, ErrorCode::kInvalidAtlas);
    return checked.error().message;
  }
  std::string check_signed(std::uint64_t file_bytes = 164) {
    header.header_checksum = checksum_of(std::as_bytes(std::span(&header, 1)).first(56));
    return check(file_bytes);
  }
};

TEST_F(HeaderTest, IsAccepted) {
  EXPECT_EQ(check(), "");
  EXPECT_EQ(header.directory_checksum, checksum_of(directory));
  EXPECT_EQ(header.directory_bytes, 100u);
}

TEST_F(HeaderTest, HasTheBytesOfTheFormat) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&header);
  const std::vector<unsigned> expected{0x89, 'S', 'P', 'L', 'A', 'T', 0x0d, 0x0a, 1,   0, 0, 0, 0, 0, 0, 0,
                                       0,    0,   0,   0,   0,   0,   0,    0,    164, 0, 0, 0, 0, 0, 0, 0,
                                       64,   0,   0,   0,   0,   0,   0,    0,    100, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(std::vector<unsigned>(bytes, bytes + 48), expected);
}

TEST_F(HeaderTest, ForeignFilesAreNotAtlases) {
  EXPECT_EQ(check(0), "not an atlas (its size is 0 bytes)");
  header.magic[0] = 'P';
  EXPECT_EQ(check(), "not an atlas (its first bytes are 50 53 50 4c 41 54 0d 0a)");
  EXPECT_THAT(check(1), StartsWith("not an atlas"));
  header.magic = kMagic;
  header.magic[7] = '\r';  // damage by a text-mode transfer
  EXPECT_THAT(check(), StartsWith("not an atlas"));
}

TEST_F(HeaderTest, TruncatedFilesAreToldWithBothSizes) {
  for (std::uint64_t bytes = 1; bytes < 64; ++bytes)
    EXPECT_THAT(check(bytes), StartsWith("truncated")) << bytes;
  EXPECT_EQ(check(163), "truncated: header says 164 bytes, file has 163");
  EXPECT_EQ(check(170), "6 trailing bytes: header says 164 bytes, file has 170");
}

TEST_F(HeaderTest, EveryFlippedBitIsSeen) {
  auto* bytes = reinterpret_cast<unsigned char*>(&header);
  for (std::size_t bit = 0; bit < 8 * sizeof header; ++bit) {
    bytes[bit / 8] = static_cast<unsigned char>(bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_THAT(check(),
                bit < 64 ? StartsWith("not an atlas") : StartsWith("damaged: checksum of the header"));
    bytes[bit / 8] = static_cast<unsigned char>(bytes[bit / 8] ^ 1 << bit % 8);
  }
}

TEST_F(HeaderTest, NewerMinorVersionsOpenAndNewerMajorOnesSayWhatTheyNeed) {
  header.minor = 9;
  header.optional_features = 0xffffffff;
  EXPECT_EQ(check_signed(), "");
  header.major = 2;
  EXPECT_EQ(check_signed(), "needs format 2, this program reads format 1");
  header.major = 1;
  header.required_features = 0x10;
  EXPECT_THAT(check_signed(), HasSubstr("needs format features 0x10"));
}

TEST_F(HeaderTest, TheDirectoryLiesInTheFile) {
  header.directory_offset = 72;
  EXPECT_THAT(check_signed(), HasSubstr("directory at 72"));
  header.directory_offset = 64;
  header.directory_bytes = 101;
  EXPECT_THAT(check_signed(), HasSubstr("directory of 101 bytes in a file of 164"));
  header.directory_bytes = ~std::uint64_t{0};
  EXPECT_THAT(check_signed(), HasSubstr("directory of"));
  header.file_bytes = std::uint64_t{1} << 40;
  header.directory_bytes = kMaxDirectoryBytes + 1;  // refused ahead of allocation
  EXPECT_THAT(check_signed(std::uint64_t{1} << 40), HasSubstr("limit"));
}

}  // namespace
}  // namespace splatlas
