// What a player shows by default: the window of grey values, and the ball that a camera frames.
#pragma once

#include "format/atlas_content.h"
#include "preprocess/classify/classify_voxels.h"

namespace splatlas {

/// The window spans the 1st to the 99.5th percentile of the finite grey values in structures that came from a
/// label map (in all structures when none did), of four million voxels at most, evenly picked. The ball is
/// around the centre of the box of all voxels of structures and reaches the farthest corner of one of them;
/// without such voxels it is the grid's. `values` is in the storage grid and may be empty.
[[nodiscard]] Display measure_display(const Classification& classification, const StructureGraph& graph,
                                      const VoxelBuffer& values, const Grid& storage_grid);

}  // namespace splatlas
