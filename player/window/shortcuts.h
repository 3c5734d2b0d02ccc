// Keyboard shortcuts.
#pragma once

#include <SDL_events.h>

#include "player/window/session/session.h"
#include "player/window/ui_state.h"

namespace splatlas {

/// Handles a key press without keyboard focus in a text field. Returns true for a shortcut.
bool handle_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui);
/// Handles shortcuts that also work in text fields: Ctrl combinations and function keys. Returns true for
/// one.
bool handle_global_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui);

/// Draws an overlay with mouse and keyboard shortcuts. Any click or key closes it.
void help_overlay(UiState& ui);

}  // namespace splatlas
