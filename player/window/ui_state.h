// What the panels tell each other beyond the session.
#pragma once

namespace splatlas {

struct UiState {
  bool focus_search = false;  ///< the search field takes the keyboard in the next frame
  bool focus_text = false;    ///< so does the selection text
  bool show_help = false;
  bool black_screen = false;  ///< the lecturer wants the audience's eyes
  bool quit = false;
};

}  // namespace splatlas
