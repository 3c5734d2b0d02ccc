// One chunk of the file: bytes in, bytes out, with a checksum. Zstandard stays inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/result.h"

namespace splatlas {

enum class ChunkCodec : std::uint8_t { kStored = 0, kZstd = 1 };

struct ChunkEntry {
  std::uint64_t checksum = 0;  ///< XXH3-64 of the stored bytes
  std::uint32_t stored_bytes = 0;
  ChunkCodec codec = ChunkCodec::kStored;
  std::uint8_t filter = 0;  ///< 0: none; others are reserved
};

struct EncodedChunk {
  ChunkEntry entry;
  std::vector<std::byte> bytes;  ///< as stored
};

/// What an encoder should look for.
enum class ChunkContent : std::uint8_t {
  kAny,
  kNoise,  ///< bytes of changing distribution in which hardly anything repeats
};

/// Compresses one chunk at a Zstandard level (1 to 22); stores it as it is where that is not smaller.
/// Thread-safe. The same bytes for the same input, level and release of Zstandard.
[[nodiscard]] EncodedChunk encode_chunk(std::span<const std::byte> decoded, int level,
                                        ChunkContent content = ChunkContent::kAny);

/// Checks the checksum and decodes into `decoded`, whose length comes from the directory, never from the
/// frame: a chunk that holds more, less, several frames or needs a dictionary is refused (kInvalidAtlas).
/// Allocates nothing that depends on the bytes. Thread-safe.
[[nodiscard]] Result<void> decode_chunk(std::span<const std::byte> stored, const ChunkEntry& entry,
                                        std::span<std::byte> decoded);

/// The checksum alone, for chunks of sections that this version does not know.
[[nodiscard]] Result<void> check_chunk(std::span<const std::byte> stored, const ChunkEntry& entry);

}  // namespace splatlas
