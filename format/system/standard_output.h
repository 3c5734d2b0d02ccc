// That what a program said has arrived.
#pragma once

#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Writes text and hands it on at once; kFailed, with the reason, when that cannot be done.
[[nodiscard]] Result<void> print_text(std::string_view text);

/// Hands on what standard output still holds; kFailed when that, or anything before, could not be written.
/// What every program does last: text that nobody got is no success.
[[nodiscard]] Result<void> finish_standard_output();

}  // namespace splatlas
