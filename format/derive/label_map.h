// Label map of an atlas, and the order of voxels in its source.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "format/content/atlas_content.h"

namespace splatlas {

/// Reorders voxels from the storage grid to the source grid.
[[nodiscard]] VoxelBuffer to_source_order(const VoxelBuffer& stored, const AtlasContent& content);

/// 1 in voxels of the structures `wanted` [structure], else 0, in the order of the source.
[[nodiscard]] VoxelBuffer mask_of(const AtlasContent& content, const std::vector<bool>& wanted);

/// The source label map, voxel for voxel in its order, without structures that have no label (segments,
/// surfaces). `wanted`: [structure]: is in it; empty: all are. kFailed if labels overlap, and for a label
/// that label_type cannot hold exactly; the message calls the atlas `name` and ends in `remedy`.
[[nodiscard]] Result<VoxelBuffer> label_map(const AtlasContent& content, const std::string& name,
                                            std::string_view remedy, const std::vector<bool>& wanted = {});

}  // namespace splatlas
