#include "format/codec/chunk_codec.h"

#include <cstring>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/io/checksum.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes repeated(std::size_t n) {
  return Bytes(n, std::byte{7});
}

Bytes noise(std::size_t n) {
  std::mt19937 random(1);
  Bytes bytes(n);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

/// The message of decoding `stored` with a right checksum; "" on success.
std::string decode(const Bytes& stored, ChunkCodec codec, std::size_t decoded_bytes,
                   std::uint8_t filter = 0) {
  const ChunkEntry entry{checksum_of(stored), static_cast<std::uint32_t>(stored.size()), codec, filter};
  Bytes decoded(decoded_bytes);
  const auto result = decode_chunk(stored, entry, decoded);
  if (result) return "";
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidAtlas);
  return result.error().message;
}

RC_GTEST_PROP(ChunkCodec, DecodesWhatWasEncoded, (std::vector<std::uint8_t> bytes, bool repeat)) {
  const auto raw = std::as_bytes(std::span(bytes));
  Bytes decoded(raw.begin(), raw.end());
  if (repeat) decoded.resize(10'000);
  const EncodedChunk chunk = encode_chunk(decoded, *rc::gen::inRange(1, 23));
  RC_ASSERT(chunk.entry.stored_bytes == chunk.bytes.size());
  RC_ASSERT(chunk.bytes.size() <= decoded.size());
  Bytes again(decoded.size(), std::byte{0xaa});
  RC_ASSERT(decode_chunk(chunk.bytes, chunk.entry, again).has_value());
  RC_ASSERT(again == decoded);
}

TEST(ChunkCodec, StoresNoiseAsItIs) {
  EXPECT_EQ(encode_chunk(noise(1000), 12).entry.codec, ChunkCodec::kStored);
  EXPECT_EQ(encode_chunk(noise(1000), 12).bytes, noise(1000));
  EXPECT_EQ(encode_chunk(repeated(1000), 12).entry.codec, ChunkCodec::kZstd);
}

TEST(ChunkCodec, SeesEveryFlippedBit) {
  for (const Bytes& decoded : {noise(100), repeated(500)}) {
    const EncodedChunk chunk = encode_chunk(decoded, 3);
    Bytes out(decoded.size());
    for (std::size_t bit = 0; bit < 8 * chunk.bytes.size(); ++bit) {
      Bytes flipped = chunk.bytes;
      flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
      EXPECT_EQ(message_of(decode_chunk(flipped, chunk.entry, out)), "checksum");
    }
  }
}

TEST(ChunkCodec, RefusesFramesOfAnotherSize) {
  const Bytes frame = encode_chunk(repeated(1000), 3).bytes;
  EXPECT_EQ(decode(frame, ChunkCodec::kZstd, 1000), "");
  EXPECT_THAT(decode(frame, ChunkCodec::kZstd, 999), HasSubstr("expected 999 bytes"));
  EXPECT_THAT(decode(frame, ChunkCodec::kZstd, 1001), HasSubstr("expected 1001 bytes"));
  EXPECT_THAT(decode(frame, ChunkCodec::kStored, 1000), HasSubstr("expected 1000"));
}

TEST(ChunkCodec, RefusesAnythingButOneFrame) {
  const Bytes frame = encode_chunk(repeated(1000), 3).bytes;
  Bytes twice = frame;
  twice.insert(twice.end(), frame.begin(), frame.end());
  EXPECT_THAT(decode(twice, ChunkCodec::kZstd, 2000), HasSubstr("not one Zstandard frame"));
  EXPECT_THAT(decode(twice, ChunkCodec::kZstd, 1000), HasSubstr("not one Zstandard frame"));

  const std::string head("\x50\x2a\x4d\x18\x04\0\0\0....", 12);  // four bytes to be skipped
  Bytes skippable(head.size() + frame.size());
  std::memcpy(skippable.data(), head.data(), head.size());
  std::ranges::copy(frame, skippable.begin() + static_cast<std::ptrdiff_t>(head.size()));
  EXPECT_THAT(decode(skippable, ChunkCodec::kZstd, 1000), HasSubstr("not a Zstandard frame"));

  for (std::size_t length = 0; length < frame.size(); ++length) {
    EXPECT_NE(decode(Bytes(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(length)),
                     ChunkCodec::kZstd, 1000),
              "");
  }
}

TEST(ChunkCodec, RefusesCodecsAndFiltersOfTheFuture) {
  EXPECT_THAT(decode(repeated(8), static_cast<ChunkCodec>(2), 8), HasSubstr("unknown codec 2"));
  EXPECT_THAT(decode(repeated(8), ChunkCodec::kStored, 8, 1), HasSubstr("unknown filter 1"));
}

RC_GTEST_PROP(ChunkCodec, SurvivesDamagedFramesWithRightChecksums, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  Bytes decoded = noise(2000);
  std::fill(decoded.begin() + 300, decoded.end(), std::byte{3});
  Bytes stored = encode_chunk(decoded, 3).bytes;
  for (int n = 0; n < 3; ++n) stored[random() % stored.size()] = static_cast<std::byte>(random());
  (void)decode(stored, ChunkCodec::kZstd, decoded.size());  // any result; sanitizers detect faults
}

}  // namespace
}  // namespace splatlas
