// Icon buttons of the draw modes: off, volume, surface, both.
#pragma once

#include <optional>
#include <string_view>

#include "player/window/layout_log.h"
#include "player/window/session/selection_editor.h"

namespace splatlas {

[[nodiscard]] float mode_buttons_width();
/// Draws one line of column heads above the buttons, at the cursor.
void mode_buttons_head(ImFont* small);

/// Draws the buttons at the cursor, at row height. The only mode in `modes` is filled; one of several is half
/// filled. Returns the clicked mode, if any. `row` names the row in the layout log.
[[nodiscard]] std::optional<DrawMode> mode_buttons(ModeSet modes, Rgb color, std::string_view row,
                                                   LayoutLog& layout);

}  // namespace splatlas
