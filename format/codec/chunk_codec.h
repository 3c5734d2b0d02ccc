// Compression and checksums of file chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/result.h"

namespace splatlas {

enum class ChunkCodec : std::uint8_t { kStored = 0, kZstd = 1 };

/// Directory entry of a chunk.
struct ChunkEntry {
  std::uint64_t checksum = 0;  ///< XXH3-64 of the stored bytes
  std::uint32_t stored_bytes = 0;
  ChunkCodec codec = ChunkCodec::kStored;
  std::uint8_t filter = 0;  ///< 0: none; others are reserved
};

/// A compressed chunk and its directory entry.
struct EncodedChunk {
  ChunkEntry entry;
  std::vector<std::byte> bytes;  ///< as stored
};

/// Hint for the encoder.
enum class ChunkContent : std::uint8_t {
  kAny,
  kNoise,  ///< few repeats, varying distribution: entropy coding gains more than matching
};

/// Compresses one chunk at a Zstandard level (1 to 22), or stores it uncompressed if that is no larger.
/// Thread-safe. Deterministic for the same input, level and Zstandard version.
[[nodiscard]] EncodedChunk encode_chunk(std::span<const std::byte> decoded, int level,
                                        ChunkContent content = ChunkContent::kAny);

/// Verifies the checksum and decodes into `decoded`, sized by the directory, not by the frame. kInvalidAtlas
/// for a chunk of another decoded length, with several frames or with a dictionary. Memory does not depend on
/// the chunk's bytes. Thread-safe.
[[nodiscard]] Result<void> decode_chunk(std::span<const std::byte> stored, const ChunkEntry& entry,
                                        std::span<std::byte> decoded);

/// Verifies only the checksum, for chunks of unknown sections.
[[nodiscard]] Result<void> check_chunk(std::span<const std::byte> stored, const ChunkEntry& entry);

}  // namespace splatlas
