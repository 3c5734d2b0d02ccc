#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "format/io/checksum.h"
#include "tests/format/atlas_surgery.h"
#include "tests/fuzz/mutators.h"
#include "tests/fuzz/seed_atlases.h"

namespace splatlas {
namespace {

/// The parts of a file whose directory can be read and laid out.
std::optional<AtlasParts> parts_of_file(const Bytes& file) {
  if (file.size() < sizeof(FileHeader)) return std::nullopt;
  const FileHeader header = header_of(file);
  if (header.directory_bytes > file.size() - sizeof header) return std::nullopt;
  const auto directory = decode_directory(directory_bytes(file));
  if (!directory || !validate(*directory)) return std::nullopt;
  const auto layout = lay_out(*directory, header.directory_bytes);
  if (!layout || layout->file_bytes() != file.size()) return std::nullopt;
  return take_apart(file);
}

/// Keeps the frame choices of the header.
Bytes put_together_again(const Bytes& directory, const std::vector<Bytes>& chunks, std::uint32_t choices) {
  Bytes file = put_together(directory, chunks);
  edit_header(file, [&](FileHeader& header) { header.reserved = choices; });
  return file;
}

/// Mutates stored bytes of a chunk, ahead of decompression.
void mutate_stored(AtlasParts& parts, std::size_t max_bytes, Random& random,
                   const MutateBytes& mutate_bytes) {
  if (parts.chunks.empty()) return;
  const std::size_t n = below(parts.chunks.size(), random);
  Bytes& stored = parts.chunks[n];
  mutate_bytes(stored, std::min(max_bytes, stored.size() + 8));
  parts.directory.chunks[n].stored_bytes = static_cast<std::uint32_t>(stored.size());
  parts.directory.chunks[n].checksum = checksum_of(stored);
}

/// Mutates one decoded stream. Only run lists and surfaces may change their length.
void mutate_stream(AtlasParts& parts, std::size_t max_bytes, Random& random,
                   const MutateBytes& mutate_bytes) {
  if (parts.directory.sections.empty()) return;
  const auto kind = static_cast<SectionKind>(any_of(parts.directory.sections, random).kind);
  if (kind < SectionKind::kRunsX || kind > SectionKind::kMeans) return;
  std::vector<Bytes> streams = decode_streams(parts, kind);
  std::vector<std::size_t> full;
  for (std::size_t n = 0; n < streams.size(); ++n) {
    if (!streams[n].empty()) full.push_back(n);
  }
  if (full.empty()) return;
  const std::size_t n = any_of(full, random);
  Bytes& stream = streams[n];
  const std::size_t before = stream.size();
  mutate_bytes(stream, std::min(max_bytes, before + 16));
  const auto now = static_cast<std::uint32_t>(stream.size());
  if (kind <= SectionKind::kRunsZ) {
    parts.directory.run_bytes[n][static_cast<std::size_t>(kind) - 1] = now;
  } else if (kind == SectionKind::kSurfaces) {
    parts.directory.surfaces[parts.directory.graph.preorder()[n]].bytes = now;
  } else {
    stream.resize(before);
  }
  replace_streams(parts, kind, streams);
}

Bytes mutate_parts(AtlasParts parts, std::size_t max_bytes, Random& random, const MutateBytes& mutate_bytes) {
  std::uint32_t choices = parts.header.reserved;
  if (below(2, random) == 0)
    choices = static_cast<std::uint32_t>(random()) * 4 + static_cast<std::uint32_t>(random() % 4);
  for (std::size_t n = 1 + below(2, random); n > 0; --n) {
    switch (below(10, random)) {
      case 0: mutate_stored(parts, max_bytes, random, mutate_bytes); break;
      case 1:
      case 2:
      case 3:
      case 4:
        mutate_directory(parts.directory, random);
        return put_together_again(encode_directory(parts.directory).value(), parts.chunks, choices);
      default: mutate_stream(parts, max_bytes, random, mutate_bytes); break;
    }
  }
  return put_together_again(encode_directory(parts.directory).value(), parts.chunks, choices);
}

Bytes any_seed(Random& random) {
  return below(8, random) == 0 ? work_seed(random) : seed_atlas(random);
}

/// Mutates the raw bytes of the directory.
Bytes mutate_directory_bytes(const Bytes& file, std::size_t max_bytes, const MutateBytes& mutate_bytes) {
  const FileHeader header = header_of(file);
  const std::size_t length = std::min<std::uint64_t>(header.directory_bytes, file.size() - sizeof header);
  const auto begin = file.begin() + sizeof header, end = begin + static_cast<std::ptrdiff_t>(length);
  Bytes directory(begin, end);
  mutate_bytes(directory, std::min(max_bytes, length + 64));
  return put_together_again(directory, {Bytes(end, file.end())}, header.reserved);
}

}  // namespace

Bytes mutate_atlas(Bytes file, std::size_t max_bytes, Random& random, const MutateBytes& mutate_bytes) {
  if (file.size() < sizeof(FileHeader) || below(50, random) == 0) return any_seed(random);
  switch (below(16, random)) {
    case 0:
      edit_header(file, [&](FileHeader& h) {
        mutate_any(random, h.major, h.minor, h.required_features, h.optional_features, h.file_bytes,
                   h.directory_offset, h.directory_bytes, h.directory_checksum);
      });
      return file;
    case 1: mutate_bytes(file, max_bytes); return file;
    case 2: return mutate_directory_bytes(file, max_bytes, mutate_bytes);
    default: break;
  }
  try {
    if (auto parts = parts_of_file(file); parts && below(64, random) == 0) {
      Bytes stretched = stretched_atlas(parts->directory, random);
      edit_header(stretched, [&](FileHeader& header) { header.reserved = parts->header.reserved; });
      return stretched;
    } else if (parts) {
      return mutate_parts(std::move(*parts), max_bytes, random, mutate_bytes);
    }
  } catch (const std::exception&) {
    // An earlier mutation made the streams undecodable.
  }
  return below(2, random) == 0 ? any_seed(random) : mutate_directory_bytes(file, max_bytes, mutate_bytes);
}

}  // namespace splatlas
