// The same atlas with more voxels: for measuring what grows with them.
#pragma once

#include "format/atlas_content.h"

namespace splatlas {

/// `times` as many voxels along each axis: the atlas's own in the middle, where they were in mm, mirrored
/// copies of it all around. The copies belong to structures of their own, "around_ID", which come last.
/// Surfaces are left out, normals are all +z; the display stays, so that cameras frame the same. `content` is
/// one that an atlas can be written of. Cost: linear in the voxels made. kInvalidAtlas when a structure has
/// such an id already.
[[nodiscard]] Result<AtlasContent> surrounded(const AtlasContent& content, const Index3& times);

/// The same structures on a finer grid, `size` voxels, no fewer than there are: each voxel is the nearest
/// one. Else as surrounded().
[[nodiscard]] AtlasContent refined(const AtlasContent& content, const Index3& size);

}  // namespace splatlas
