// State of the user interface shared by the panels.
#pragma once

namespace splatlas {

struct UiState {
  bool focus_search = false;  ///< gives the search field the keyboard focus in the next frame
  bool focus_text = false;    ///< gives the selection text the keyboard focus in the next frame
  bool show_help = false;
  bool black_screen = false;  ///< blanks the screen during a lecture
  bool quit = false;
};

}  // namespace splatlas
