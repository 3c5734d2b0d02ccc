// Derived surfaces and normals, which files leave out.
#pragma once

#include "format/atlas_content.h"

namespace splatlas {

/// Replaces the surface and normals of a structure by those that readers derive from its voxels, as
/// preprocess does.
void fit_parts(AtlasContent& content, StructureIndex structure);

}  // namespace splatlas
