// The window from opening to closing.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Opens the atlas, then a window on it, and returns when the user closes it. Sleeps while nothing happens.
/// What open() of an atlas fails with; kFailed when there is no display. Main thread only.
[[nodiscard]] Result<void> run_window_loop(const std::filesystem::path& atlas, unsigned threads);

}  // namespace splatlas
