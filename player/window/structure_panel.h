// Panel of structures: search, tree with mode buttons, facts and controls of the current structure.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Fills the current ImGui window.
void structure_panel(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout);

}  // namespace splatlas
