// Surfaces and normals that files leave out.
#pragma once

#include "format/atlas_content.h"

namespace splatlas {

/// In place of a structure's surface and normals, those that readers find from its voxels: as preprocess
/// makes them.
void fit_parts(AtlasContent& content, StructureIndex structure);

}  // namespace splatlas
