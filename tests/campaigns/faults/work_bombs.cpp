#include "tests/campaigns/faults/work_bombs.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/sparse_atlas.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

Bytes two_voxels(const Index3& size) {
  return sparse_atlas(size, {{voxel_box({0, 0, 0}), voxel_box({size[0] - 1, size[1] - 1, size[2] - 1})}});
}

/// One structure of voxels at every other place, so that every voxel is a run of every axis.
Bytes lattice(std::int64_t columns, std::int64_t rows, std::int64_t slices) {
  SparseStructure voxels;
  for (std::int64_t k = 0; k < slices; ++k) {
    for (std::int64_t j = 0; j < rows; ++j) {
      for (std::int64_t i = 0; i < columns; ++i) voxels.push_back(voxel_box({3 * i, 3 * j, 3 * k}));
    }
  }
  return sparse_atlas({3 * columns, 3 * rows, 3 * slices}, {voxels});
}

/// Two voxels, and voxels at every other place in three structures. One more structure holds all of them.
Bytes two_voxels_of_a_lattice(std::int64_t columns, std::int64_t rows) {
  std::vector<SparseStructure> structures(4);
  const Index3 size{3 * columns, 3 * rows + 9, 9};
  structures[0] = {voxel_box({0, 0, 0}), voxel_box({3 * columns - 1, 3 * rows + 8, 8})};
  for (std::int64_t j = 0; j < rows; ++j) {
    for (std::int64_t i = 0; i < columns; ++i)
      structures[static_cast<std::size_t>(1 + i % 3)].push_back(voxel_box({3 * i, 3 * j, 4}));
  }
  return sparse_atlas(size, structures, true);
}

/// Three lines through the middle of a cube, one along every axis: few voxels, and no empty slice.
Bytes cross(std::int64_t side) {
  const std::int64_t m = side / 2;
  return sparse_atlas({side, side, side}, {{{{0, m, m - 9}, {side - 1, m, m - 9}}},
                                           {{{m, 0, m}, {m, side - 1, m}}},
                                           {{{m, m - 9, 0}, {m, m - 9, m - 12}}}});
}

/// A diagonal of voxels: as many rows, columns and slices as voxels.
Bytes diagonal(std::int64_t voxels) {
  SparseStructure all;
  for (std::int64_t n = 0; n < voxels; ++n) all.push_back(voxel_box({3 * n, 3 * n, 3 * n}));
  return sparse_atlas({3 * voxels, 3 * voxels, 3 * voxels}, {all});
}

/// A plate of two voxels' thickness.
Bytes plate(std::int64_t side) {
  return sparse_atlas({side, side, 2}, {{{{0, 0, 0}, {side - 1, side - 1, 1}}}});
}

/// A number from 1 to `most`, of any magnitude.
std::int64_t magnitude(std::int64_t most, std::mt19937& random) {
  const double share = std::uniform_real_distribution<double>(0, 1)(random);
  return std::clamp<std::int64_t>(std::llround(std::exp(share * std::log(static_cast<double>(most)))), 1,
                                  most);
}

}  // namespace

Bytes fitted_pairs(std::int64_t structures, std::int64_t side) {
  std::vector<SparseStructure> all;
  for (std::int64_t n = 0; n < structures; ++n)
    all.push_back({voxel_box({3 * n, 0, 0}), voxel_box({3 * n + side, side, side})});
  return sparse_atlas({side + 3 * structures + 1, side + 1, side + 1}, all);
}

Bytes layered_graph(std::size_t layers, std::size_t per_layer) {
  TestVolume volume;
  volume.grid.size = {2, 2, 2};
  for (std::size_t layer = 0; layer < layers; ++layer) {
    std::vector<StructureIndex> parents;
    for (std::size_t n = 0; layer > 0 && n < per_layer; ++n)
      parents.push_back(static_cast<StructureIndex>((layer - 1) * per_layer + n));
    for (std::size_t n = 0; n < per_layer; ++n)
      volume.structures.push_back(
          {"s" + std::to_string(volume.structures.size()), {}, {255, 255, 255}, parents});
  }
  volume.structures.back().mask = box_mask(volume.grid.size, {0, 0, 0}, {0, 0, 0});
  return encode_atlas(make_content(volume)).value();
}

Bytes with_zero_values(const Bytes& file) {
  AtlasParts parts = take_apart(file);
  parts.directory.value_type = VoxelType::kFloat64;
  constexpr std::uint32_t kChunkBytes = 1u << 24;
  const auto cuts =
      cut_streams(begins_of(stream_sizes(parts.directory, SectionKind::kValues)), kChunkBytes, 0, 1u << 20)
          .value();
  const EncodedChunk whole = encode_chunk(Bytes(kChunkBytes), 3);
  for (std::size_t n = 0; n + 1 < cuts.size(); ++n) {
    const std::uint64_t bytes = cuts[n + 1] - cuts[n];
    const EncodedChunk chunk = bytes == kChunkBytes ? whole : encode_chunk(Bytes(bytes), 3);
    parts.directory.chunks.push_back(chunk.entry);
    parts.chunks.push_back(chunk.bytes);
  }
  const auto is_values = [](const SectionEntry& section) {
    return section.kind == static_cast<std::uint32_t>(SectionKind::kValues);
  };
  std::erase_if(parts.directory.sections, is_values);
  parts.directory.sections.push_back({static_cast<std::uint32_t>(SectionKind::kValues),
                                      static_cast<std::uint32_t>(cuts.size() - 1), kChunkBytes, 0});
  return put_together(parts);
}

std::vector<WorkBomb> work_bombs() {
  std::vector<WorkBomb> bombs;
  for (const auto& [name, size] :
       std::vector<std::pair<const char*, Index3>>{{"2^24 x 2^16", {1 << 24, 1 << 16, 1}},
                                                   {"2^16 x 2^24", {1 << 16, 1 << 24, 1}},
                                                   {"1 x 2^16 x 2^24", {1, 1 << 16, 1 << 24}},
                                                   {"a row of 2^24", {1, 1, 1 << 24}},
                                                   {"8192^3", {8192, 8192, 8192}},
                                                   {"2000^3", {2000, 2000, 2000}},
                                                   {"640^3", {640, 640, 640}},
                                                   {"280^3", {280, 280, 280}}})
    bombs.push_back({std::string("two voxels in ") + name, [size = size] { return two_voxels(size); }});
  for (const auto& [name, size] : std::vector<std::pair<const char*, Index3>>{
           {"30 MB", {160, 160, 150}}, {"48 MB", {200, 200, 150}}, {"4 GB", {800, 800, 800}}})
    bombs.push_back(
        {std::string(name) + " of values", [size = size] { return with_zero_values(two_voxels(size)); }});
  const std::vector<WorkBomb> others{
      {"20 fitted pairs", [] { return fitted_pairs(20, 500); }},
      {"1000 fitted pairs", [] { return fitted_pairs(1000, 500); }},
      {"228 600 parents", [] { return layered_graph(255, 30); }},
      {"many groups", [] { return layered_graph(2, 300); }},
      {"1 million runs", [] { return lattice(1000, 1000, 1); }},
      {"1.5 million runs", [] { return lattice(1000, 1500, 1); }},
      {"1.5 million runs in a cube", [] { return lattice(115, 115, 115); }},
      {"6 million runs", [] { return lattice(3000, 2000, 1); }},
      {"2 of 6 million runs", [] { return two_voxels_of_a_lattice(3000, 2000); }, "s0"},
      {"cross of 500", [] { return cross(500); }},
      {"cross of 16000", [] { return cross(8000); }},
      {"diagonal of 600", [] { return diagonal(600); }},
      {"diagonal of 3000", [] { return diagonal(3000); }},
      {"plate of 300^2", [] { return plate(300); }},
      {"plate of 900^2", [] { return plate(900); }},
      {"plate of 4000^2", [] { return plate(4000); }},
  };
  bombs.insert(bombs.end(), others.begin(), others.end());
  return bombs;
}

Bytes sparse_giant(std::uint32_t seed, const SparseExtent& extent) {
  std::mt19937 random(seed);
  Index3 size;
  std::int64_t rest = kMaxVoxels;
  for (std::int64_t& side : size) {
    side = magnitude(std::min(rest, kMaxAxisSize), random);
    rest /= side;
  }
  std::shuffle(size.begin(), size.end(), random);
  std::vector<SparseStructure> structures(static_cast<std::size_t>(magnitude(extent.structures, random)));
  std::vector<IndexBox> placed;
  for (SparseStructure& structure : structures) {
    const std::int64_t boxes = magnitude(extent.boxes, random);
    for (int tries = 0; tries < 1000 && (structure.empty() || tries < boxes); ++tries) {
      IndexBox box;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t side =
            magnitude(std::min<std::int64_t>(size[a], a == seed % 3 ? 2 : extent.side), random);
        box.first[a] = std::uniform_int_distribution<std::int64_t>(0, size[a] - side)(random);
        box.last[a] = box.first[a] + side - 1;
      }
      if (std::ranges::any_of(placed, [&](const IndexBox& other) { return are_near(box, other); })) continue;
      placed.push_back(box);
      structure.push_back(box);
    }
  }
  std::erase_if(structures, [](const SparseStructure& structure) { return structure.empty(); });
  return sparse_atlas(size, structures);
}

}  // namespace splatlas
