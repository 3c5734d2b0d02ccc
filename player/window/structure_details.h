// What there is to say about the chosen structure, and what can be done with it.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/theme.h"

namespace splatlas {

/// Height that structure_details() takes, whatever is chosen: the tree above it does not jump.
[[nodiscard]] float structure_details_height();
void structure_details(Session& session, const Fonts& fonts, LayoutLog& layout);

}  // namespace splatlas
