#include "format/file/file_layout.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "format/codec/value_codec.h"
#include "format/io/checksum.h"
#include "format/result_macros.h"

namespace splatlas {

static_assert(std::endian::native == std::endian::little,
              "atlas files are little-endian and copied without conversion");

namespace {

constexpr std::size_t kChecksummedHeaderBytes = offsetof(FileHeader, header_checksum);
/// Limits of chunk_bytes, because chunks are decoded as a whole.
constexpr std::uint32_t kMinChunkBytes = 4096, kMaxChunkBytes = 1u << 24;

std::uint64_t header_checksum(const FileHeader& header) {
  return checksum_of(std::as_bytes(std::span(&header, 1)).first(kChecksummedHeaderBytes));
}

/// Message for a file without the magic number.
std::string foreign_file(std::span<const std::byte> start) {
  if (start.empty()) return "not an atlas (its size is 0 bytes)";
  std::string first;
  for (std::size_t n = 0; n < std::min<std::size_t>(start.size(), 8); ++n) {
    first += fmt::format("{}{:02x}", n == 0 ? "" : " ", std::to_integer<unsigned>(start[n]));
  }
  return fmt::format("not an atlas (its first bytes are {})", first);
}

Result<void> check_version(const FileHeader& header) {
  if (header.major != kFormatMajor) {
    return invalid_atlas("needs format {}, this program reads format {}", header.major, kFormatMajor);
  }
  if (header.required_features != 0) {
    return invalid_atlas("needs format features {:#x} that this program (format {}.{}) does not know",
                         header.required_features, kFormatMajor, kFormatMinor);
  }
  return {};
}

}  // namespace

FileHeader make_header(std::span<const std::byte> directory, std::uint64_t file_bytes, FileHeader header) {
  header.file_bytes = file_bytes;
  header.directory_bytes = directory.size();
  header.directory_checksum = checksum_of(directory);
  header.header_checksum = header_checksum(header);
  return header;
}

tl::unexpected<Error> wrong_checksum(const char* part, std::uint64_t found, std::uint64_t stated) {
  return invalid_atlas(
      "damaged: checksum of the {} is {:016x}, the file states {:016x}; copy or build the file again", part,
      found, stated);
}

Result<FileHeader> check_header(std::span<const std::byte> start, std::uint64_t file_bytes) {
  const std::size_t magic_bytes = std::min(start.size(), kMagic.size());
  if (start.empty() || std::memcmp(start.data(), kMagic.data(), magic_bytes) != 0) {
    return fail(ErrorCode::kInvalidAtlas, foreign_file(start));
  }
  if (start.size() < sizeof(FileHeader)) {
    return invalid_atlas("truncated: the header has {} bytes, the file has {}", sizeof(FileHeader),
                         file_bytes);
  }
  FileHeader header;
  std::memcpy(&header, start.data(), sizeof header);
  if (const std::uint64_t found = header_checksum(header); found != header.header_checksum)
    return wrong_checksum("header", found, header.header_checksum);
  SPLATLAS_RETURN_IF_ERROR(check_version(header));
  if (file_bytes < header.file_bytes) {
    return invalid_atlas("truncated: header says {} bytes, file has {}", header.file_bytes, file_bytes);
  }
  if (file_bytes > header.file_bytes) {
    return invalid_atlas("{} trailing bytes: header says {} bytes, file has {}",
                         file_bytes - header.file_bytes, header.file_bytes, file_bytes);
  }
  if (header.directory_offset != sizeof(FileHeader)) {
    return invalid_atlas("invalid: directory at {}, expected {}", header.directory_offset,
                         sizeof(FileHeader));
  }
  if (header.directory_bytes > file_bytes - sizeof(FileHeader) ||
      header.directory_bytes > kMaxDirectoryBytes) {
    return invalid_atlas("invalid: directory of {} bytes in a file of {} (limit {})", header.directory_bytes,
                         file_bytes, kMaxDirectoryBytes);
  }
  return header;
}

const SectionLayout* FileLayout::find(SectionKind kind) const {
  const auto found = std::ranges::find(sections, static_cast<std::uint32_t>(kind), &SectionLayout::kind);
  return found == sections.end() ? nullptr : &*found;
}

std::vector<std::uint64_t> stream_sizes(const Directory& directory, SectionKind kind) {
  return stream_sizes(directory, ValueGroups(directory.classes), kind);
}

std::vector<std::uint64_t> stream_sizes(const Directory& directory, const ValueGroups& groups,
                                        SectionKind kind) {
  std::vector<std::uint64_t> sizes;
  if (kind == SectionKind::kSurfaces) {
    for (const StructureIndex s : directory.graph.preorder()) sizes.push_back(directory.surfaces[s].bytes);
    return sizes;
  }
  const ClassTable& classes = directory.classes;
  const Index3 size = reordered(directory.source_grid, directory.source_to_storage).size;
  if (kind == SectionKind::kValues) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      sizes.push_back(value_code_bytes(directory.value_type, group_box(groups, classes, g, size),
                                       group_voxels(groups, classes, g)));
    }
    return sizes;
  }
  if (kind == SectionKind::kMeans) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const IndexBox blocks = box_of_blocks(group_box(groups, classes, g, size));
      sizes.push_back(value_code_bytes(directory.value_type, blocks, directory.mean_blocks[g]));
    }
    return sizes;
  }
  if (kind == SectionKind::kNormals) {
    for (ClassId c = 0; c < classes.size(); ++c)
      sizes.push_back(stores_normals(directory, c) ? classes.voxels(c) * sizeof(PackedNormal) : 0);
    return sizes;
  }
  const auto axis = static_cast<std::size_t>(kind) - static_cast<std::size_t>(run_section(Axis::kX));
  for (const std::array<std::uint32_t, 3>& bytes : directory.run_bytes) sizes.push_back(bytes[axis]);
  return sizes;
}

std::vector<std::uint64_t> begins_of(std::span<const std::uint64_t> sizes) {
  std::vector<std::uint64_t> begins(sizes.size() + 1, 0);
  for (std::size_t n = 0; n < sizes.size(); ++n) begins[n + 1] = begins[n] + sizes[n];
  return begins;
}

std::optional<std::vector<std::uint64_t>> cut_streams(std::span<const std::uint64_t> stream_begin,
                                                      std::uint64_t chunk_bytes, std::uint64_t shared_bytes,
                                                      std::uint64_t max_chunks) {
  std::vector<std::uint64_t> cuts{0};  // the last one is the begin of the current chunk
  const auto full = [&] { return cuts.size() > max_chunks + 1; };
  for (std::size_t n = 0; n + 1 < stream_begin.size(); ++n) {
    const std::uint64_t begin = stream_begin[n], end = stream_begin[n + 1];
    if (end - cuts.back() <= shared_bytes || begin == end) continue;
    if (begin > cuts.back()) cuts.push_back(begin);
    if (end - begin <= shared_bytes) continue;
    while (end - cuts.back() > chunk_bytes && !full()) cuts.push_back(cuts.back() + chunk_bytes);
    cuts.push_back(end);
    if (full()) return std::nullopt;
  }
  if (stream_begin.back() > cuts.back()) cuts.push_back(stream_begin.back());
  if (full()) return std::nullopt;
  return cuts;
}

namespace {

bool is_known(std::uint32_t kind) {
  return kind >= static_cast<std::uint32_t>(SectionKind::kRunsX) &&
         kind <= static_cast<std::uint32_t>(SectionKind::kMeans);
}

/// Divides the streams of a known section and compares with its chunks.
Result<void> lay_out_streams(const Directory& directory, const ValueGroups& groups, const SectionEntry& entry,
                             SectionLayout& section) {
  if (entry.chunk_bytes < kMinChunkBytes || entry.chunk_bytes > kMaxChunkBytes ||
      entry.chunk_bytes % 8 != 0 || entry.shared_bytes > entry.chunk_bytes) {
    return invalid_atlas("invalid: section {} is cut every {} bytes, shared up to {}",
                         section_name(entry.kind), entry.chunk_bytes, entry.shared_bytes);
  }
  section.stream_begin = begins_of(stream_sizes(directory, groups, static_cast<SectionKind>(entry.kind)));
  auto cuts = cut_streams(section.stream_begin, entry.chunk_bytes, entry.shared_bytes, entry.chunks);
  if (!cuts || cuts->size() != std::size_t{entry.chunks} + 1) {
    return invalid_atlas("invalid: section {} has {} chunks, its streams of {} bytes need {}",
                         section_name(entry.kind), entry.chunks, section.stream_begin.back(),
                         cuts ? std::to_string(cuts->size() - 1) : std::string("more"));
  }
  section.chunk_begin = std::move(*cuts);
  for (std::uint32_t n = 0; n < entry.chunks; ++n) {
    const std::uint64_t stored = directory.chunks[section.first_chunk + n].stored_bytes;
    const std::uint64_t decoded = section.chunk_begin[n + 1] - section.chunk_begin[n];
    if (stored == 0 || stored > decoded) {
      return invalid_atlas("invalid: chunk {} of section {} stores {} bytes as {}", n,
                           section_name(entry.kind), decoded, stored);
    }
  }
  return {};
}

/// Checks for missing and unexpected sections.
Result<void> check_presence(const Directory& directory, const FileLayout& layout) {
  const bool has_values = directory.value_type != VoxelType::kNone;
  const auto require = [&](SectionKind kind) -> Result<void> {
    if (layout.find(kind)) return {};
    return invalid_atlas("invalid: section {} is missing", section_name(kind));
  };
  SPLATLAS_RETURN_IF_ERROR(require(SectionKind::kRunsZ));
  SPLATLAS_RETURN_IF_ERROR(require(SectionKind::kNormals));
  SPLATLAS_RETURN_IF_ERROR(require(SectionKind::kSurfaces));
  if (has_values) SPLATLAS_RETURN_IF_ERROR(require(SectionKind::kValues));
  if (!has_values && layout.find(SectionKind::kValues))
    return invalid_atlas("invalid: values without a value type");
  return {};
}

}  // namespace

Result<FileLayout> lay_out(const Directory& directory, std::uint64_t directory_bytes) {
  return lay_out(directory, ValueGroups(directory.classes), directory_bytes);
}

Result<FileLayout> lay_out(const Directory& directory, const ValueGroups& groups,
                           std::uint64_t directory_bytes) {
  FileLayout layout;
  std::uint64_t offset = sizeof(FileHeader) + directory_bytes;
  layout.chunk_offset.reserve(directory.chunks.size() + 1);
  layout.chunk_offset.push_back(offset);
  for (const ChunkEntry& chunk : directory.chunks) {
    offset += chunk.stored_bytes;  // cannot overflow: at most 2^26 chunks of 2^32 bytes
    layout.chunk_offset.push_back(offset);
  }
  std::size_t next_chunk = 0;
  for (const SectionEntry& entry : directory.sections) {
    if (entry.chunks > directory.chunks.size() - next_chunk) {
      return invalid_atlas("invalid: section {} has {} chunks, {} are left", section_name(entry.kind),
                           entry.chunks, directory.chunks.size() - next_chunk);
    }
    if (std::ranges::count(layout.sections, entry.kind, &SectionLayout::kind) != 0) {
      return invalid_atlas("invalid: section {} occurs twice", section_name(entry.kind));
    }
    SectionLayout section;
    section.kind = entry.kind;
    section.first_chunk = static_cast<std::uint32_t>(next_chunk);
    if (is_known(entry.kind)) SPLATLAS_RETURN_IF_ERROR(lay_out_streams(directory, groups, entry, section));
    section.stored_bytes = layout.chunk_offset[next_chunk + entry.chunks] - layout.chunk_offset[next_chunk];
    next_chunk += entry.chunks;
    layout.sections.push_back(std::move(section));
  }
  if (next_chunk != directory.chunks.size()) {
    return invalid_atlas("invalid: {} chunks belong to no section", directory.chunks.size() - next_chunk);
  }
  SPLATLAS_RETURN_IF_ERROR(check_presence(directory, layout));
  return layout;
}

}  // namespace splatlas
