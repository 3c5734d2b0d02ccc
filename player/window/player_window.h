// Player window, loaded from a module.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Shows an atlas in a window until the user closes it. Loads the window module with SDL2, OpenGL and Dear
/// ImGui, so that the other commands do not depend on them. kFailed, with an alternative, if the module
/// cannot be loaded or there is no display. Errors of Atlas::open() come before any window. Main thread only.
[[nodiscard]] Result<void> run_window(const std::filesystem::path& atlas, unsigned threads);

}  // namespace splatlas
