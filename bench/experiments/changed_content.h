// Larger and smaller atlases made of another.
#pragma once

#include "format/content/atlas_content.h"
#include "format/content/selection.h"

namespace splatlas {

/// `times` as many voxels along each axis: the atlas at its place, surrounded by mirrored copies. Copies
/// belong to their own structures "around_ID", which come last. Without surfaces; all normals are +z. The
/// display stays, and with it the framing of cameras. `content` must be valid for an atlas. Cost: linear in
/// the new voxels. kInvalidAtlas if such an id exists.
[[nodiscard]] Result<AtlasContent> surrounded(const AtlasContent& content, const Index3& times);

/// The same structures on a finer grid of `size` voxels by nearest neighbour, otherwise as surrounded(). No
/// side may shrink.
[[nodiscard]] AtlasContent refined(const AtlasContent& content, const Index3& size);

/// The content reduced to the structures of the selection: no other class, surface or grey value (0 instead).
/// Structures that are not drawn stay in the graph, without voxels. Unlit and lit pictures of the selection
/// stay the same.
[[nodiscard]] AtlasContent isolated(const AtlasContent& content, const Selection& selection);

}  // namespace splatlas
