// Text field of the selection, and status line.
#pragma once

#include <string>

#include "player/window/layout_log.h"
#include "player/window/session/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// The field shows the text of the selection. Enter applies typed text; Escape discards it.
class SelectionBar {
 public:
  [[nodiscard]] static float height();
  /// Draws the field, its buttons, and a line with errors, messages or hints.
  void draw(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout);

 private:
  std::string typed_;
  std::uint64_t version_ = 0;  // version of the selection in `typed_`
};

}  // namespace splatlas
