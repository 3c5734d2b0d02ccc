// Mean grey values in blocks of voxels, for first pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/content/run_model.h"

namespace splatlas {

/// Blocks have 2^kMeanLevel voxels along each axis. Block (i, j, k) begins at voxel (4i, 4j, 4k); the grid of
/// blocks is coarse_grid(grid, kMeanLevel).
inline constexpr int kMeanLevel = 2;

/// The blocks with voxels of some classes, in memory order of the grid of blocks.
struct BlockMeans {
  ClassRuns runs;                    ///< of blocks, principal axis z
  std::vector<std::uint8_t> voxels;  ///< [block]: voxels of the classes, 1 to 64
  std::vector<std::byte> values;     ///< [block]: means, of the atlas's value type
};

}  // namespace splatlas
