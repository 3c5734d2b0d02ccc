#include "format/codec/chunk_codec.h"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace splatlas {
namespace {

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

}  // namespace
}  // namespace splatlas
