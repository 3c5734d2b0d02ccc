// Fuzz target: untrusted chunks with right checksums, decoded to the declared length or refused.
// Input: a byte of choices, the decoded length (u16), a level (u8), stored bytes.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "format/codec/chunk_codec.h"
#include "format/io/checksum.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

/// Compressed bytes come back; a flipped bit is detected.
void check_round_trip(std::span<const std::byte> content, int level, ChunkContent kind) {
  EncodedChunk chunk = encode_chunk(content, level, kind);
  require(chunk.bytes.size() <= content.size() && chunk.bytes.size() == chunk.entry.stored_bytes,
          "a chunk stores more than its content, or says so");
  std::vector<std::byte> decoded(content.size());
  require(decode_chunk(chunk.bytes, chunk.entry, decoded).has_value(), "an encoded chunk is refused");
  require(std::ranges::equal(decoded, content), "an encoded chunk decodes to something else");
  if (chunk.bytes.empty()) return;
  chunk.bytes[static_cast<std::size_t>(level) % chunk.bytes.size()] ^= std::byte{4};
  require(!decode_chunk(chunk.bytes, chunk.entry, decoded).has_value(), "a flipped bit is not seen");
}

void fuzz_chunks(FuzzInput input) {
  const auto choices = input.number<std::uint8_t>();
  std::vector<std::byte> decoded(input.number<std::uint16_t>());
  const int level = 1 + static_cast<int>(input.below(12));
  const auto stored = input.rest();
  const ChunkContent kind = (choices & 1) != 0 ? ChunkContent::kNoise : ChunkContent::kAny;
  if ((choices & 2) != 0) return check_round_trip(stored, level, kind);

  const ChunkEntry entry{checksum_of(stored), static_cast<std::uint32_t>(stored.size()),
                         static_cast<ChunkCodec>(choices >> 2 & 3),
                         static_cast<std::uint8_t>(choices >> 4 == 15 ? 1 : 0)};
  const Result<void> done = decode_chunk(stored, entry, decoded);
  if (!done) return require_error(done.error(), {ErrorCode::kInvalidAtlas});
  check_round_trip(decoded, level, kind);
}

const FuzzTarget kChunks("chunks", fuzz_chunks);

}  // namespace
}  // namespace splatlas
