// View panel: toolbar, picture and mouse interaction.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/picture_texture.h"
#include "player/window/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Fills the current ImGui window except for `height_below` at its bottom.
/// Drag: orbit. Drag with Shift, or with the right or middle button: pan. Wheel: zoom at the pointer. Click:
/// make the structure current. Double click: reset the view.
void view_panel(Session& session, UiState& ui, PictureTexture& texture, const Fonts& fonts, LayoutLog& layout,
                float height_below);

}  // namespace splatlas
