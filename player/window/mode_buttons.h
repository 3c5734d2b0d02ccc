// Off, volume, surface, both: four small buttons with a picture each.
#pragma once

#include <optional>
#include <string_view>

#include "player/window/layout_log.h"
#include "player/window/selection_editor.h"

namespace splatlas {

[[nodiscard]] float mode_buttons_width();
/// One line with the words above the buttons, from the cursor on, in a font smaller than theirs.
void mode_buttons_head(ImFont* small);

/// Draws the buttons at the cursor, as high as a row. A mode that all drawable structures have is filled, one
/// that only some have is half filled. Returns the mode that was clicked. `row` names the row in the layout.
[[nodiscard]] std::optional<DrawMode> mode_buttons(ModeSet modes, Rgb color, std::string_view row,
                                                   LayoutLog& layout);

}  // namespace splatlas
