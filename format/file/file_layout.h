// File layout of an atlas: header, and offsets of sections, chunks and streams, for writer and reader.
//
//   0                     FileHeader, 64 bytes
//   64                    directory (FlatBuffers, schemas/atlas.fbs)
//   64 + directory_bytes  chunks of all sections in order, without gaps, up to the end of the file
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/result.h"

namespace splatlas {

inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 0;
/// Maximum size of a directory, below the limit of FlatBuffers (2 GiB).
inline constexpr std::uint64_t kMaxDirectoryBytes = std::uint64_t{1} << 30;
/// As in PNG, a high bit and CR LF detect transfers that alter bytes.
inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'S', 'P', 'L', 'A', 'T', '\r', '\n'};

/// The first 64 bytes, little-endian. The layout is the same in all versions of the format.
struct FileHeader {
  std::array<std::uint8_t, 8> magic = kMagic;
  std::uint16_t major = kFormatMajor;
  std::uint16_t minor = kFormatMinor;
  std::uint32_t required_features = 0;  ///< no bit is defined yet; files with one are refused
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

/// kInvalidAtlas: the header or directory, `part`, has another checksum than the file states.
[[nodiscard]] tl::unexpected<Error> wrong_checksum(const char* part, std::uint64_t found,
                                                   std::uint64_t stated);

/// The complete header of a file, with checksums. Version and features are those of `header`.
[[nodiscard]] FileHeader make_header(std::span<const std::byte> directory, std::uint64_t file_bytes,
                                     FileHeader header = {});
/// Checks the header of a file of `file_bytes` bytes. `start` has its first 64 bytes, or all of a shorter
/// file. kInvalidAtlas if it is not an atlas, damaged, truncated, too long, or of a newer version.
[[nodiscard]] Result<FileHeader> check_header(std::span<const std::byte> start, std::uint64_t file_bytes);

/// Streams and chunks of a section as intervals of its decoded bytes. Neither have gaps.
struct SectionLayout {
  std::uint32_t kind = 0;
  std::uint32_t first_chunk = 0;            ///< index of its first chunk in the file
  std::vector<std::uint64_t> stream_begin;  ///< streams + 1 decoded offsets; empty for unknown kinds
  std::vector<std::uint64_t> chunk_begin;   ///< chunks + 1 decoded offsets; empty for unknown kinds
  std::uint64_t stored_bytes = 0;
};

/// Sections and chunk offsets of a file.
struct FileLayout {
  std::vector<SectionLayout> sections;      ///< in file order
  std::vector<std::uint64_t> chunk_offset;  ///< chunks + 1 offsets in the file
  [[nodiscard]] std::uint64_t file_bytes() const { return chunk_offset.back(); }
  [[nodiscard]] const SectionLayout* find(SectionKind kind) const;
};

/// Decoded lengths of the streams of a section: run lists and normals per class, values and means per group
/// of classes (see ValueGroups), surfaces per structure in preorder of the graph.
[[nodiscard]] std::vector<std::uint64_t> stream_sizes(const Directory& directory, SectionKind kind);

/// The same with precomputed groups.
[[nodiscard]] std::vector<std::uint64_t> stream_sizes(const Directory& directory, const ValueGroups& groups,
                                                      SectionKind kind);

/// Divides concatenated streams (`stream_begin`: streams + 1 offsets) into chunks. Streams longer than
/// `shared_bytes` are split every `chunk_bytes`; consecutive shorter streams share chunks of up to
/// `shared_bytes`. Returns chunks + 1 offsets, or nullopt for more than `max_chunks` chunks.
[[nodiscard]] std::optional<std::vector<std::uint64_t>> cut_streams(
    std::span<const std::uint64_t> stream_begin, std::uint64_t chunk_bytes, std::uint64_t shared_bytes,
    std::uint64_t max_chunks);

/// Prefix sums of `sizes`: begin offsets, and the end of the last.
[[nodiscard]] std::vector<std::uint64_t> begins_of(std::span<const std::uint64_t> sizes);

/// Computes the layout of a file. kInvalidAtlas for duplicate or missing sections, and for chunks that do not
/// match the streams of the directory. `directory` must pass validate().
[[nodiscard]] Result<FileLayout> lay_out(const Directory& directory, std::uint64_t directory_bytes);
/// The same with precomputed groups.
[[nodiscard]] Result<FileLayout> lay_out(const Directory& directory, const ValueGroups& groups,
                                         std::uint64_t directory_bytes);

}  // namespace splatlas
