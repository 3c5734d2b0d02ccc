// The selection as text, and what there is to tell.
#pragma once

#include <string>

#include "player/window/layout_log.h"
#include "player/window/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// The text field follows the selection, until it is typed into; Enter applies, Escape takes it back.
class SelectionBar {
 public:
  [[nodiscard]] static float height();
  /// Draws the field, its buttons, and a line below for errors, messages or hints.
  void draw(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout);

 private:
  std::string typed_;
  std::uint64_t version_ = 0;  // of the selection that `typed_` follows
};

}  // namespace splatlas
