// Main loop of the player window.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Opens an atlas, shows it in a window, and returns when the user closes the window. Sleeps between events.
/// Errors of Atlas::open(), and kFailed without a display. Main thread only.
[[nodiscard]] Result<void> run_window_loop(const std::filesystem::path& atlas, unsigned threads);

}  // namespace splatlas
