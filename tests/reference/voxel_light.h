// Normals of the voxels of a volume, and the shares of their emissions that depend on them.
#pragma once

#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/content/unit_vector.h"

namespace splatlas::reference {

struct LitVoxel {
  double lit = 0;
  PackedNormal normal = 0;
};

/// Of all voxels of the grid; unselected ones are unlit.
[[nodiscard]] std::vector<LitVoxel> lit_voxels(const AtlasContent& content, const Selection& selection);

}  // namespace splatlas::reference
