// Atlas of 1000 voxels with every feature of the format.
#pragma once

#include "format/content/atlas_content.h"

namespace splatlas {

/// A group of two boxes, one of them with a surface and normals derived from its voxels, and a ball that
/// overlaps both. Grey values depend on `seed`; the file layout does not.
[[nodiscard]] AtlasContent small_atlas(unsigned seed = 1);

}  // namespace splatlas
