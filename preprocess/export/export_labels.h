// Classes become labels again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "format/atlas_content.h"

namespace splatlas {

/// Voxels of the storage grid in the order of the source.
[[nodiscard]] VoxelBuffer to_source_order(const VoxelBuffer& stored, const AtlasContent& content);

/// The label map that the atlas was made from, voxel for voxel, as a volume file. Structures without a label
/// (segments, surfaces) leave no trace. kFailed when the sources were masks, or labels overlap. `name` stands
/// for the atlas in messages.
[[nodiscard]] Result<void> export_label_map(const AtlasContent& content, const std::string& name,
                                            const std::filesystem::path& path);

/// A new folder with one mask (uint8, 1 inside) per structure, named by its id: ID.nii.gz. Groups and
/// external surfaces have none. The folder appears whole or not at all; it must not exist yet, or be empty.
/// Returns the number of masks.
[[nodiscard]] Result<std::size_t> export_masks(const AtlasContent& content,
                                               const std::filesystem::path& folder);

}  // namespace splatlas
