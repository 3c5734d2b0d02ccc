// An atlas of a few structures of another one.
#pragma once

#include "format/atlas_content.h"
#include "format/selection.h"

namespace splatlas {

/// The content with the structures that the selection draws and no others: no class, surface or grey value of
/// the rest (0 instead), groups without a drawn structure above them. The grid and the display stay, so that
/// pictures of the selection, unlit, are the same. `selection` gets the new structures' numbers.
[[nodiscard]] Result<AtlasContent> isolated(const AtlasContent& content, const Selection& selection,
                                            Selection& isolated_selection);

}  // namespace splatlas
