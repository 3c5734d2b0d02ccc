// View panel: toolbar, picture and mouse interaction.
#pragma once

#include <memory>

#include "player/window/layout_log.h"
#include "player/window/session/session.h"
#include "player/window/theme.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Toolbar, latest picture as an OpenGL texture, and caption. Requires a current OpenGL context, also for
/// destruction. Main thread only.
class ViewPanel {
 public:
  ViewPanel() = default;
  ~ViewPanel();
  ViewPanel(const ViewPanel&) = delete;
  ViewPanel& operator=(const ViewPanel&) = delete;

  /// Fills the current ImGui window except for `height_below` at its bottom.
  /// Drag: orbit. Drag with Shift, or with the right or middle button: pan. Wheel: zoom at the pointer.
  /// Click: make the structure current. Double click: fit the view to the structure, or to the selection.
  void draw(Session& session, UiState& ui, const Fonts& fonts, LayoutLog& layout, float height_below);

 private:
  void upload(const std::shared_ptr<const DisplayFrame>& frame);

  unsigned texture_ = 0;
  std::shared_ptr<const DisplayFrame> frame_;
};

}  // namespace splatlas
