#include "tests/format/second_reader/second_reader.h"

#include <algorithm>
#include <map>

#include <xxhash.h>
#include <zstd.h>

#include "tests/format/second_reader/flat_directory.h"
#include "tests/format/second_reader/plain_codecs.h"

namespace splatlas::second {
namespace {

using Bytes = std::vector<std::byte>;

void must(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

// ---- the file

Bytes slice(const Bytes& bytes, std::uint64_t begin, std::uint64_t length) {
  must(begin + length <= bytes.size(), "beyond the end");
  return Bytes(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
               bytes.begin() + static_cast<std::ptrdiff_t>(begin + length));
}

/// "Cutting": end positions of chunks, for contiguous streams.
std::vector<std::uint64_t> cut(const std::vector<std::uint64_t>& lengths, const SectionRow& section) {
  std::vector<std::uint64_t> ends;
  std::uint64_t last_end = 0, position = 0;
  const auto end_chunk = [&](std::uint64_t at) {
    if (at != last_end) ends.push_back(last_end = at);
  };
  for (const std::uint64_t length : lengths) {
    const std::uint64_t b = position, e = position += length;
    if (e == b || e - last_end <= section.shared_bytes) continue;
    end_chunk(b);
    if (e - b > section.shared_bytes) {
      for (std::uint64_t at = b + section.chunk_bytes; at < e; at += section.chunk_bytes) end_chunk(at);
      end_chunk(e);
    }
  }
  end_chunk(position);
  return ends;
}

Bytes decode_chunk(const Bytes& stored, const ChunkRow& row, std::uint64_t decoded_bytes) {
  must(XXH3_64bits(stored.data(), stored.size()) == row.checksum, "checksum of a chunk");
  must(row.filter == 0 && row.codec <= 1, "codec or filter");
  if (row.codec == 0) return stored;
  Bytes decoded(decoded_bytes);
  must(ZSTD_decompress(decoded.data(), decoded.size(), stored.data(), stored.size()) == decoded_bytes,
       "frame");
  return decoded;
}

/// Contents of a file, section by section.
class Sections {
 public:
  Sections(const Bytes& file, const FlatDirectory& directory, std::uint64_t first_chunk_at)
      : file_(file), directory_(directory), first_chunk_at_(first_chunk_at) {}

  [[nodiscard]] bool has(std::uint32_t kind) const {
    return std::ranges::count(directory_.sections, kind, &SectionRow::kind) == 1;
  }
  /// The streams of a section, with these lengths.
  [[nodiscard]] std::vector<Bytes> streams(std::uint32_t kind,
                                           const std::vector<std::uint64_t>& lengths) const {
    std::size_t chunk = 0;
    for (const SectionRow& section : directory_.sections) {
      if (section.kind == kind) return split(decode(section, chunk, lengths), lengths);
      chunk += section.chunks;
    }
    throw std::runtime_error("no such section");
  }

 private:
  [[nodiscard]] Bytes decode(const SectionRow& section, std::size_t chunk,
                             const std::vector<std::uint64_t>& lengths) const {
    const std::vector<std::uint64_t> ends = cut(lengths, section);
    must(ends.size() == section.chunks, "number of chunks");
    std::uint64_t at = first_chunk_at_, begin = 0;
    for (std::size_t n = 0; n < chunk; ++n) at += directory_.chunks[n].stored_bytes;
    Bytes all;
    for (const std::uint64_t end : ends) {
      const ChunkRow& row = directory_.chunks.at(chunk++);
      const Bytes decoded = decode_chunk(slice(file_, at, row.stored_bytes), row, end - begin);
      all.insert(all.end(), decoded.begin(), decoded.end());
      at += row.stored_bytes;
      begin = end;
    }
    return all;
  }
  [[nodiscard]] static std::vector<Bytes> split(const Bytes& all, const std::vector<std::uint64_t>& lengths) {
    std::vector<Bytes> streams;
    std::uint64_t at = 0;
    for (const std::uint64_t length : lengths) {
      streams.push_back(slice(all, at, length));
      at += length;
    }
    return streams;
  }

  const Bytes& file_;
  const FlatDirectory& directory_;
  std::uint64_t first_chunk_at_;
};

// ---- run lists

class Varints {
 public:
  explicit Varints(const Bytes& bytes) : bytes_(bytes) {}
  std::uint64_t next() {
    std::uint64_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(bytes_.at(at_++));
      value |= (byte & 127) << shift;
      if (byte < 128) return value;
    }
  }
  std::int64_t next_signed() {
    const std::uint64_t v = next();
    return v % 2 == 0 ? static_cast<std::int64_t>(v / 2) : -static_cast<std::int64_t>(v / 2) - 1;
  }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

struct Run {
  std::int64_t scanline = 0, start = 0, length = 0;
};

/// The runs of a list, each with the run that predicts it: the same rank in the previous scanline.
std::vector<Run> read_runs(const Bytes& list) {
  if (list.empty()) return {};
  Varints numbers(list);
  std::vector<Run> runs(numbers.next());
  std::int64_t scanline = 0;
  for (Run& run : runs) run.scanline = scanline += static_cast<std::int64_t>(numbers.next());
  std::vector<std::ptrdiff_t> model(runs.size(), -1);  // -1: none
  std::size_t previous = 0, current = 0;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    if (n > 0 && runs[n].scanline != runs[n - 1].scanline) {
      previous = current;
      current = n;
    }
    const std::size_t same_rank = previous + (n - current);
    if (same_rank < current) model[n] = static_cast<std::ptrdiff_t>(same_rank);
  }
  const auto at = [&](std::ptrdiff_t n) -> const Run& { return runs[static_cast<std::size_t>(n)]; };
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::int64_t predicted = model[n] >= 0 ? at(model[n]).length : n == 0 ? 1 : runs[n - 1].length;
    runs[n].length = predicted + numbers.next_signed();
  }
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const bool first_of_scanline = n == 0 || runs[n].scanline != runs[n - 1].scanline;
    const std::int64_t behind = first_of_scanline ? 0 : runs[n - 1].start + runs[n - 1].length + 1;
    runs[n].start = (model[n] >= 0 ? at(model[n]).start : behind) + numbers.next_signed();
  }
  must(numbers.at_end(), "bytes behind a run list");
  return runs;
}

/// The voxels that a list covers, in memory order.
std::vector<bool> covered(const std::vector<Run>& runs, const std::array<std::int64_t, 3>& size,
                          std::size_t axis) {
  std::vector<bool> voxels(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  for (const Run& run : runs) {
    const std::int64_t rows = axis == 2 ? size[1] : size[2];
    const std::int64_t slice = run.scanline / rows, row = run.scanline % rows;
    for (std::int64_t along = run.start; along < run.start + run.length; ++along) {
      const std::int64_t i = axis == 0 ? slice : along;
      const std::int64_t j = axis == 0 ? along : axis == 1 ? slice : row;
      const std::int64_t k = axis == 2 ? slice : row;
      voxels.at(static_cast<std::size_t>((k * size[1] + j) * size[0] + i)) = true;
    }
  }
  return voxels;
}

/// True if all 18 neighbours of a voxel are covered.
bool is_inside(const std::vector<bool>& voxels, const std::array<std::int64_t, 3>& size, std::size_t voxel) {
  const auto v = static_cast<std::int64_t>(voxel);
  const std::int64_t i = v % size[0], j = v / size[0] % size[1], k = v / (size[0] * size[1]);
  for (std::int64_t dk = -1; dk <= 1; ++dk) {
    for (std::int64_t dj = -1; dj <= 1; ++dj) {
      for (std::int64_t di = -1; di <= 1; ++di) {
        if (di * di + dj * dj + dk * dk > 2) continue;
        const std::int64_t ni = i + di, nj = j + dj, nk = k + dk;
        if (ni < 0 || nj < 0 || nk < 0 || ni >= size[0] || nj >= size[1] || nk >= size[2]) return false;
        if (!voxels[static_cast<std::size_t>((nk * size[1] + nj) * size[0] + ni)]) return false;
      }
    }
  }
  return true;
}

// ---- groups

/// Classes with the same structures, each crossed in all or in none, ordered by first class.
std::vector<std::vector<std::size_t>> groups_of(const FlatDirectory& directory) {
  std::map<std::vector<std::pair<std::uint32_t, bool>>, std::size_t> known;
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < directory.classes.size(); ++c) {
    std::vector<std::pair<std::uint32_t, bool>> key;
    for (const std::uint32_t m : directory.classes[c].members) key.emplace_back(m / 4, m % 4 == 2);
    const auto [group, is_new] = known.emplace(key, groups.size());
    if (is_new) groups.emplace_back();
    groups[group->second].push_back(c);
  }
  return groups;
}

/// True if the second class of a group shares the list of the first along an axis.
bool shares_list(const FlatDirectory& directory, const std::vector<std::size_t>& group, std::size_t axis) {
  if (group.size() != 2) return false;
  const ClassRow& second = directory.classes[group[1]];
  return second.voxels > 0 && second.run_bytes[axis] == 0;
}

/// The voxels that the stream of a class covers: a list, or a mask of its box.
std::vector<bool> covered_by(const Bytes& stream, const FlatDirectory& directory,
                             const std::vector<std::size_t>& group, std::size_t c, std::size_t axis) {
  if (stream.empty() || stream.front() != std::byte{0})
    return covered(read_runs(stream), directory.size, axis);
  auto first = directory.classes[c].box_first, last = directory.classes[c].box_last;
  if (shares_list(directory, group, axis)) {
    const ClassRow& second = directory.classes[group[1]];
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = last[a] < 0 ? second.box_first[a] : std::min(first[a], second.box_first[a]);
      last[a] = std::max(last[a], second.box_last[a]);
    }
  }
  return decode_mask(stream, first, last, directory.size, axis);
}

/// Compares the fingerprint of each class with its definition.
void check_fingerprints(const FlatDirectory& directory, const std::vector<std::uint32_t>& volume) {
  __extension__ using Wide = unsigned __int128;
  constexpr Wide kPrime = (Wide{1} << 61) - 1, kBase = Wide{0x243f6a8885a308d3} % kPrime;
  std::vector<Wide> sums(directory.classes.size());
  Wide power = 1;
  for (const std::uint32_t c : volume) {
    sums.at(c) = (sums.at(c) + power) % kPrime;
    power = power * kBase % kPrime;
  }
  for (std::size_t c = 0; c < sums.size(); ++c)
    must(sums[c] == directory.fingerprints.at(c), "a fingerprint of other voxels");
}

std::vector<std::uint32_t> read_class_volume(const Sections& sections, const FlatDirectory& directory,
                                             std::size_t axis) {
  const auto kind = static_cast<std::uint32_t>(axis + 1);
  std::vector<std::uint32_t> volume;
  if (!sections.has(kind)) return volume;
  std::vector<std::uint64_t> lengths;
  for (const ClassRow& row : directory.classes) lengths.push_back(row.run_bytes[axis]);
  const std::vector<Bytes> lists = sections.streams(kind, lengths);
  volume.resize(static_cast<std::size_t>(directory.size[0] * directory.size[1] * directory.size[2]));
  for (const std::vector<std::size_t>& group : groups_of(directory)) {
    const bool shared = shares_list(directory, group, axis);
    for (const std::size_t c : group) {
      const std::vector<bool> voxels = covered_by(lists[c], directory, group, c, axis);
      for (std::size_t v = 0; v < voxels.size(); ++v) {
        if (!voxels[v]) continue;
        must(volume[v] == 0, "classes overlap");
        const bool second = shared && !is_inside(voxels, directory.size, v);
        volume[v] = static_cast<std::uint32_t>(second ? group[1] : c);
      }
    }
  }
  check_fingerprints(directory, volume);
  return volume;
}

// ---- values and normals

std::size_t value_bytes(std::uint8_t type) {
  return std::array<std::size_t, 9>{0, 1, 1, 2, 2, 4, 4, 4, 8}.at(type);
}

/// Width and height of the bounding box of a group; those of the grid for the empty class.
std::array<std::int64_t, 2> box_of(const FlatDirectory& directory, const std::vector<std::size_t>& group) {
  if (group.front() == 0) return {directory.size[0], directory.size[1]};
  std::array<std::int64_t, 2> first{1 << 24, 1 << 24}, last{-1, -1};
  for (const std::size_t c : group) {
    if (directory.classes[c].voxels == 0) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      first[a] = std::min(first[a], directory.classes[c].box_first[a]);
      last[a] = std::max(last[a], directory.classes[c].box_last[a]);
    }
  }
  return {last[0] - first[0] + 1, last[1] - first[1] + 1};
}

Bytes read_values(const Sections& sections, const FlatDirectory& directory,
                  const std::vector<std::uint32_t>& class_volume) {
  const std::size_t bytes = value_bytes(directory.value_type);
  Bytes values(class_volume.size() * bytes);
  if (bytes == 0) return values;
  const std::vector<std::vector<std::size_t>> groups = groups_of(directory);
  std::vector<std::uint64_t> lengths;
  std::vector<bool> predicted;
  for (const std::vector<std::size_t>& group : groups) {
    std::uint64_t voxels = 0;
    for (const std::size_t c : group) voxels += directory.classes[c].voxels;
    const auto [width, height] = box_of(directory, group);
    predicted.push_back(is_predicted(directory.value_type, voxels, width, height));
    lengths.push_back(voxels * bytes + (predicted.back() ? kModelBytes : 0));
  }
  const std::vector<Bytes> streams = sections.streams(4, lengths);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::size_t> voxels;
    for (std::size_t v = 0; v < class_volume.size(); ++v) {
      if (std::ranges::count(groups[g], class_volume[v]) != 0) voxels.push_back(v);
    }
    const Bytes of_group = predicted[g]
                               ? decode_predicted(streams[g], voxels, directory.size, directory.value_type)
                               : streams[g];
    for (std::size_t n = 0; n < voxels.size() * bytes; ++n)
      values[voxels[n / bytes] * bytes + n % bytes] = of_group[n];
  }
  return values;
}

/// Compares the stored means with those of the values.
void check_means(const Sections& sections, const FlatDirectory& directory,
                 const std::vector<std::uint32_t>& class_volume, const Bytes& values) {
  if (directory.mean_blocks.empty()) return;
  std::vector<Blocks> blocks;
  std::vector<std::uint64_t> lengths;
  for (const std::vector<std::size_t>& group : groups_of(directory)) {
    const std::uint32_t stored = directory.mean_blocks.at(blocks.size());
    std::vector<std::size_t> voxels;
    for (std::size_t v = 0; stored > 0 && v < class_volume.size(); ++v) {
      if (std::ranges::count(group, class_volume[v]) != 0) voxels.push_back(v);
    }
    blocks.push_back(blocks_of(voxels, directory.size, directory.value_type));
    must(blocks.back().voxels.size() == stored, "number of means");
    lengths.push_back(stored * value_bytes(directory.value_type) +
                      (blocks.back().predicted ? kModelBytes : 0));
  }
  const std::vector<Bytes> streams = sections.streams(7, lengths);
  for (std::size_t g = 0; g < blocks.size(); ++g)
    must(has_means(blocks[g], streams[g], values, directory.value_type), "a mean");
}

std::vector<std::vector<std::uint16_t>> read_normals(const Sections& sections,
                                                     const FlatDirectory& directory) {
  std::vector<std::uint64_t> lengths;
  for (const ClassRow& row : directory.classes) {
    const bool boundary = std::ranges::any_of(row.members, [](std::uint32_t m) { return m % 4 == 1; });
    lengths.push_back(boundary && !row.normals_fitted ? 2 * row.voxels : 0);
  }
  std::vector<std::vector<std::uint16_t>> normals;
  for (const Bytes& stream : sections.streams(5, lengths)) {
    normals.emplace_back(stream.size() / 2);
    if (!stream.empty()) std::memcpy(normals.back().data(), stream.data(), stream.size());
  }
  return normals;
}

}  // namespace

Atlas read_atlas(const std::vector<std::byte>& file) {
  constexpr std::array<unsigned char, 8> kMagic{0x89, 'S', 'P', 'L', 'A', 'T', '\r', '\n'};
  must(file.size() >= 64 && std::memcmp(file.data(), kMagic.data(), kMagic.size()) == 0, "magic");
  must(XXH3_64bits(file.data(), 56) == number_at<std::uint64_t>(file, 56), "checksum of the header");
  must(number_at<std::uint16_t>(file, 8) == 1 && number_at<std::uint32_t>(file, 12) <= 1, "version");
  must(number_at<std::uint64_t>(file, 24) == file.size() && number_at<std::uint64_t>(file, 32) == 64,
       "lengths");
  const auto directory_bytes = number_at<std::uint64_t>(file, 40);
  const Bytes bytes = slice(file, 64, directory_bytes);
  must(XXH3_64bits(bytes.data(), bytes.size()) == number_at<std::uint64_t>(file, 48),
       "checksum of the directory");
  const FlatDirectory directory = read_directory(bytes);
  const Sections sections(file, directory, 64 + directory_bytes);

  Atlas atlas;
  atlas.size = directory.size;
  atlas.value_type = directory.value_type;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    atlas.class_volume[axis] = read_class_volume(sections, directory, axis);
  }
  atlas.values = read_values(sections, directory, atlas.class_volume[2]);
  check_means(sections, directory, atlas.class_volume[2], atlas.values);
  atlas.normals = read_normals(sections, directory);
  return atlas;
}

}  // namespace splatlas::second
