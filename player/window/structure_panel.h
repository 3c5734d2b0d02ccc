// Tree panel of structures, with search and mode buttons.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Fills the current ImGui window except for `height_below` pixels at its bottom.
void structure_panel(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout,
                     float height_below);

}  // namespace splatlas
