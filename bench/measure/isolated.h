// Atlas of a subset of structures.
#pragma once

#include "format/content/atlas_content.h"
#include "format/content/selection.h"

namespace splatlas {

/// The content reduced to the structures of the selection: no other class, surface or grey value (0 instead),
/// and no parents that are not drawn. Grid and display stay, so that unlit pictures of the selection are
/// equal. `selection` gets the new structure indices.
[[nodiscard]] Result<AtlasContent> isolated(const AtlasContent& content, const Selection& selection,
                                            Selection& isolated_selection);

}  // namespace splatlas
