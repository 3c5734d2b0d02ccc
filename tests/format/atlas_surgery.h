// Atlas files taken apart, edited and reassembled with right checksums, as an attacker would.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "format/codec/chunk_codec.h"
#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/io/checksum.h"

namespace splatlas {

using Bytes = std::vector<std::byte>;

/// Parts of an atlas file. Change them at will: put_together() checks nothing.
struct AtlasParts {
  FileHeader header;
  Directory directory;
  std::vector<Bytes> chunks;  ///< stored bytes, in file order
};

/// The bytes from `begin` to before `end`.
inline Bytes slice(const Bytes& bytes, std::size_t begin, std::size_t end) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(begin),
          bytes.begin() + static_cast<std::ptrdiff_t>(end)};
}

inline FileHeader header_of(const Bytes& file) {
  FileHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  return header;
}

/// Changes the header and repairs its checksum.
template <typename Change>
void edit_header(Bytes& file, const Change& change) {
  FileHeader header = header_of(file);
  change(header);
  header.header_checksum =
      checksum_of(std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum)));
  std::memcpy(file.data(), &header, sizeof header);
}

/// The directory bytes of a file.
inline Bytes directory_bytes(const Bytes& file) {
  return slice(file, sizeof(FileHeader), sizeof(FileHeader) + header_of(file).directory_bytes);
}

inline AtlasParts take_apart(const Bytes& file) {
  const Bytes directory = directory_bytes(file);
  AtlasParts parts{header_of(file), decode_directory(directory).value(), {}};
  const FileLayout layout = lay_out(parts.directory, directory.size()).value();
  for (std::size_t n = 0; n < parts.directory.chunks.size(); ++n)
    parts.chunks.push_back(slice(file, layout.chunk_offset[n], layout.chunk_offset[n + 1]));
  return parts;
}

/// A file of this directory and these chunks, with right lengths and checksums in the header.
inline Bytes put_together(const Bytes& directory, const std::vector<Bytes>& chunks) {
  std::size_t size = sizeof(FileHeader) + directory.size();
  for (const Bytes& chunk : chunks) size += chunk.size();
  const FileHeader header = make_header(directory, size);
  Bytes file(size);
  std::memcpy(file.data(), &header, sizeof header);
  auto end = std::ranges::copy(directory, file.begin() + sizeof header).out;
  for (const Bytes& chunk : chunks) end = std::ranges::copy(chunk, end).out;
  return file;
}

inline Bytes put_together(const AtlasParts& parts) {
  return put_together(encode_directory(parts.directory).value(), parts.chunks);
}

/// The decoded streams of a section.
inline std::vector<Bytes> decode_streams(const AtlasParts& parts, SectionKind kind) {
  const FileLayout layout = lay_out(parts.directory, 0).value();
  const SectionLayout& section = *layout.find(kind);
  Bytes decoded(section.stream_begin.back());
  for (std::size_t n = 0; n + 1 < section.chunk_begin.size(); ++n) {
    const std::size_t chunk = section.first_chunk + n, begin = section.chunk_begin[n];
    const auto done = decode_chunk(parts.chunks[chunk], parts.directory.chunks[chunk],
                                   std::span(decoded).subspan(begin, section.chunk_begin[n + 1] - begin));
    if (!done) throw std::runtime_error(done.error().message);
  }
  std::vector<Bytes> streams;
  for (std::size_t n = 0; n + 1 < section.stream_begin.size(); ++n)
    streams.push_back(slice(decoded, section.stream_begin[n], section.stream_begin[n + 1]));
  return streams;
}

/// Replaces a section's streams, cut and compressed as by the writer. The caller adjusts the directory.
inline void replace_streams(AtlasParts& parts, SectionKind kind, const std::vector<Bytes>& streams) {
  std::size_t first = 0;
  for (SectionEntry& section : parts.directory.sections) {
    if (section.kind != static_cast<std::uint32_t>(kind)) {
      first += section.chunks;
      continue;
    }
    const auto at = static_cast<std::ptrdiff_t>(first),
               end = static_cast<std::ptrdiff_t>(first + section.chunks);
    parts.chunks.erase(parts.chunks.begin() + at, parts.chunks.begin() + end);
    parts.directory.chunks.erase(parts.directory.chunks.begin() + at, parts.directory.chunks.begin() + end);
    Bytes decoded;
    std::vector<std::uint64_t> sizes;
    for (const Bytes& stream : streams) {
      decoded.insert(decoded.end(), stream.begin(), stream.end());
      sizes.push_back(stream.size());
    }
    const auto cuts =
        cut_streams(begins_of(sizes), section.chunk_bytes, section.shared_bytes, 1u << 20).value();
    section.chunks = static_cast<std::uint32_t>(cuts.size() - 1);
    for (std::size_t n = cuts.size() - 1; n-- > 0;) {
      EncodedChunk chunk = encode_chunk(std::span(decoded).subspan(cuts[n], cuts[n + 1] - cuts[n]), 1);
      parts.chunks.insert(parts.chunks.begin() + at, std::move(chunk.bytes));
      parts.directory.chunks.insert(parts.directory.chunks.begin() + at, chunk.entry);
    }
    return;
  }
  throw std::invalid_argument("the file has no such section");
}

}  // namespace splatlas
