// Small atlases to begin with.
#pragma once

#include <cstddef>
#include <vector>

#include "format/atlas_content.h"
#include "tests/fuzz/mutate_number.h"

namespace splatlas {

/// Everything that atlases may hold, in a few voxels: surfaces and normals as they fit the voxels, or any.
[[nodiscard]] AtlasContent seed_content(Random& random);

/// The same as a file, compact or not.
[[nodiscard]] std::vector<std::byte> seed_atlas(Random& random);

}  // namespace splatlas
