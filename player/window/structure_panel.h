// The tree of structures, with a search and modes for every row.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Fills the current ImGui window down to `height_below` pixels above its end.
void structure_panel(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout,
                     float height_below);

}  // namespace splatlas
