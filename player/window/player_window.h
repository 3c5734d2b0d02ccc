// splatlas-player ATLAS: the window, from the program's side.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Shows an atlas in a window until the user closes it. SDL2, OpenGL and Dear ImGui stand in a module of
/// their own that is loaded here: `render`, `info` and `verify` neither need them nor wait for them. kFailed,
/// saying how to go on without, when the module cannot be loaded or there is no display; kInvalidAtlas,
/// before any window opens, for a file that is none. Main thread only.
[[nodiscard]] Result<void> run_window(const std::filesystem::path& atlas, unsigned threads);

}  // namespace splatlas
