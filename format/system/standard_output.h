// Checked writes to standard output.
#pragma once

#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Writes text and flushes; kFailed, with the reason, on error.
[[nodiscard]] Result<void> print_text(std::string_view text);

/// Flushes standard output; kFailed if this or any earlier write failed. Programs call it last, to report
/// lost output.
[[nodiscard]] Result<void> finish_standard_output();

}  // namespace splatlas
