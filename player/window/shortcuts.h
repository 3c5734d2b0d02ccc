// What the keys do.
#pragma once

#include <SDL_events.h>

#include "player/window/session.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Acts on a key that was pressed while no field has the keyboard; true when it means something.
bool handle_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui);
/// The keys that also work while a field has the keyboard: with Ctrl, and function keys.
bool handle_global_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui);

/// An overlay that lists mouse and keys; closed by any click or key.
void help_overlay(UiState& ui);

}  // namespace splatlas
