// Panel with facts and controls of the current structure.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/theme.h"

namespace splatlas {

/// Height of structure_details(), constant so that the tree above it does not move.
[[nodiscard]] float structure_details_height();
void structure_details(Session& session, const Fonts& fonts, LayoutLog& layout);

}  // namespace splatlas
