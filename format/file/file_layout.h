// Where everything is in an atlas file. The only place where offsets are computed: writer and reader both
// call it.
//
//   0                     FileHeader, 64 bytes
//   64                    directory (FlatBuffers, schemas/atlas.fbs)
//   64 + directory_bytes  chunks of the first section, of the second, ... : back to back, up to the last byte
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/result.h"

namespace splatlas {

inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 0;
/// Feature bits that this version knows. A file that requires another one is refused.
inline constexpr std::uint32_t kKnownRequiredFeatures = 0;
/// A directory larger than this is refused before a byte of it is read (FlatBuffers itself ends at 2 GiB).
inline constexpr std::uint64_t kMaxDirectoryBytes = std::uint64_t{1} << 30;
/// A high bit, a control character and both line ends: transfers that change bytes are seen at once.
inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'S', 'P', 'L', 'A', 'T', '\r', '\n'};

/// The first 64 bytes, little-endian. Its layout is the same in every version of the format.
struct FileHeader {
  std::array<std::uint8_t, 8> magic = kMagic;
  std::uint16_t major = kFormatMajor;
  std::uint16_t minor = kFormatMinor;
  std::uint32_t required_features = 0;
  std::uint32_t optional_features = 0;
  std::uint32_t reserved = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t directory_offset = sizeof(FileHeader);
  std::uint64_t directory_bytes = 0;
  std::uint64_t directory_checksum = 0;  ///< XXH3-64
  std::uint64_t header_checksum = 0;     ///< XXH3-64 of the 56 bytes before
};
static_assert(sizeof(FileHeader) == 64);
static_assert(offsetof(FileHeader, major) == 8 && offsetof(FileHeader, minor) == 10);
static_assert(offsetof(FileHeader, required_features) == 12 && offsetof(FileHeader, optional_features) == 16);
static_assert(offsetof(FileHeader, file_bytes) == 24 && offsetof(FileHeader, directory_offset) == 32);
static_assert(offsetof(FileHeader, directory_bytes) == 40 && offsetof(FileHeader, directory_checksum) == 48);
static_assert(offsetof(FileHeader, header_checksum) == 56);

/// A complete header for a directory and a file length, checksums included.
[[nodiscard]] FileHeader make_header(std::span<const std::byte> directory, std::uint64_t file_bytes);
/// Checks the header of a file of `file_bytes` bytes. `start` holds its first 64 bytes, or all of a shorter
/// file. kInvalidAtlas: not an atlas, damaged, truncated, trailing bytes, too new.
[[nodiscard]] Result<FileHeader> check_header(std::span<const std::byte> start, std::uint64_t file_bytes);

/// Where a section's streams and chunks are. Streams lie back to back in the decoded section; so do the
/// chunks' decoded bytes: both are ranges of one decoded address space.
struct SectionLayout {
  std::uint32_t kind = 0;
  std::uint32_t first_chunk = 0;            ///< number of its first chunk in the file
  std::vector<std::uint64_t> stream_begin;  ///< streams + 1 decoded positions; empty for unknown kinds
  std::vector<std::uint64_t> chunk_begin;   ///< chunks + 1 decoded positions; empty for unknown kinds
  std::uint64_t stored_bytes = 0;
};

struct FileLayout {
  std::vector<SectionLayout> sections;      ///< in file order
  std::vector<std::uint64_t> chunk_offset;  ///< chunks + 1 positions in the file
  [[nodiscard]] std::uint64_t file_bytes() const { return chunk_offset.back(); }
  [[nodiscard]] const SectionLayout* find(SectionKind kind) const;
};

/// The decoded length of every stream of a section: run lists and normals per class (in class order), values
/// per group of classes (see ValueGroups), surfaces per structure in preorder of the graph.
[[nodiscard]] std::vector<std::uint64_t> stream_sizes(const Directory& directory, SectionKind kind);

/// The same, with the groups that the classes are in.
[[nodiscard]] std::vector<std::uint64_t> stream_sizes(const Directory& directory, const ValueGroups& groups,
                                                      SectionKind kind);

/// Cuts streams that lie back to back (`stream_begin`: streams + 1 positions) into chunks: streams longer
/// than `shared_bytes` into pieces of `chunk_bytes` of their own; consecutive shorter ones together into
/// chunks of up to `shared_bytes`. Returns chunks + 1 positions, or nothing when there would be more than
/// `max_chunks`.
[[nodiscard]] std::optional<std::vector<std::uint64_t>> cut_streams(
    std::span<const std::uint64_t> stream_begin, std::uint64_t chunk_bytes, std::uint64_t shared_bytes,
    std::uint64_t max_chunks);

/// Positions where values of these sizes begin, and where the last ends.
[[nodiscard]] std::vector<std::uint64_t> begins_of(std::span<const std::uint64_t> sizes);

/// The layout of a file. Refuses (kInvalidAtlas) sections that repeat, lack a needed one, or whose chunks do
/// not come to the streams that the directory describes. `directory` has passed validate().
[[nodiscard]] Result<FileLayout> lay_out(const Directory& directory, std::uint64_t directory_bytes);
/// The same, with the groups that the classes are in.
[[nodiscard]] Result<FileLayout> lay_out(const Directory& directory, const ValueGroups& groups,
                                         std::uint64_t directory_bytes);

}  // namespace splatlas
