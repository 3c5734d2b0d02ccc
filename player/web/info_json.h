// Contents of an atlas as JSON.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"

namespace splatlas {

/// JSON document, safe to print, with grid, structures in the order of their indices, counts, sizes, named
/// views and scenes. Cost: that of subtree_counts(). Thread-safe.
[[nodiscard]] std::string info_json(const Atlas& atlas);

/// [structure]: voxels and triangles of it and its descendants.
[[nodiscard]] std::vector<SubtreeCounts> counts_of(const Atlas& atlas);

}  // namespace splatlas
