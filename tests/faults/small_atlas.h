// An atlas of 1000 voxels that has everything an atlas can have.
#pragma once

#include "format/atlas_content.h"

namespace splatlas {

/// A group of two boxes, one with a surface and normals that follow from its voxels, a ball that overlaps
/// both, and grey values that depend on `seed`; with any other seed, the same places in the file.
[[nodiscard]] AtlasContent small_atlas(unsigned seed = 1);

}  // namespace splatlas
