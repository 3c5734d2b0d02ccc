// The picture, and the mouse upon it.
#pragma once

#include "player/window/layout_log.h"
#include "player/window/picture_texture.h"
#include "player/window/session.h"
#include "player/window/theme.h"

namespace splatlas {

/// Fills the current ImGui window down to `height_below` above its end, with the name under the pointer at
/// the foot. Drag turns; drag with shift, or with the right or middle button, moves; the wheel zooms at the
/// pointer; a click chooses; a double click resets the view.
void view_panel(Session& session, PictureTexture& texture, const Fonts& fonts, LayoutLog& layout,
                float height_below);

}  // namespace splatlas
