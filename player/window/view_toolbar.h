// Toolbar above the picture.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Draws one line of buttons: standard views, reset, save, help.
void view_toolbar(Session& session, UiState& ui, LayoutLog& layout);

}  // namespace splatlas
