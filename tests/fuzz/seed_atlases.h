// Seed atlases of fuzz targets.
#pragma once

#include <cstddef>
#include <vector>

#include "format/content/atlas_content.h"
#include "tests/fuzz/mutate_number.h"

namespace splatlas {

/// Every feature in a few voxels. Surfaces and normals are random or derived from the voxels.
[[nodiscard]] AtlasContent seed_content(Random& random);

/// Such an atlas as a file, compact or not.
[[nodiscard]] std::vector<std::byte> seed_atlas(Random& random);

/// A file below 8 KiB that asks for much work: a large sparse grid, fitted surfaces in large boxes, a deep or
/// wide graph, or grey values that compress to almost nothing.
[[nodiscard]] std::vector<std::byte> work_seed(Random& random);

}  // namespace splatlas
