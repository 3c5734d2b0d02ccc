// Atlas files of less than 2 MiB that ask for much work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace splatlas {

struct WorkBomb {
  std::string name;
  std::function<std::vector<std::byte>()> make;
  std::string selection{};  ///< rendered, too, unless empty
};

/// Two voxels in giant grids, fitted surfaces in large boxes, deep graphs, long lists of runs, grey values
/// that decompress to gigabytes, and files that just keep within the budget.
[[nodiscard]] std::vector<WorkBomb> work_bombs();

/// Upper bounds of the structures, boxes per structure and voxels a side of a box.
struct SparseExtent {
  std::int64_t structures = 30, boxes = 20, side = 300;
};

/// A random grid of up to 2^40 voxels with structures of some boxes each.
[[nodiscard]] std::vector<std::byte> sparse_giant(std::uint32_t seed, const SparseExtent& extent = {});

/// Structures of two voxels, whose bounding boxes overlap and have `side` voxels a side.
[[nodiscard]] std::vector<std::byte> fitted_pairs(std::int64_t structures, std::int64_t side);

/// Layers of structures, each a child of all structures in the layer above.
[[nodiscard]] std::vector<std::byte> layered_graph(std::size_t layers, std::size_t per_layer);

/// The file with grey values of 0: 8 bytes per voxel that compress to almost nothing.
[[nodiscard]] std::vector<std::byte> with_zero_values(const std::vector<std::byte>& file);

}  // namespace splatlas
