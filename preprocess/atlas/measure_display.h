// Default display window and bounding sphere of an atlas.
#pragma once

#include "format/content/atlas_content.h"
#include "preprocess/classify/classify_voxels.h"

namespace splatlas {

/// The window is the 1st to the 99.5th percentile of finite grey values in labelled structures, or in all
/// structures if none has a label. Large volumes are subsampled regularly. The sphere is centred on the
/// bounding box of all structures' voxels and contains their corners; without such voxels it is that of the
/// grid. `values` is in the storage grid and may be empty.
[[nodiscard]] Display measure_display(const Classification& classification, const StructureGraph& graph,
                                      const VoxelBuffer& values, const Grid& storage_grid);

}  // namespace splatlas
