// Validation of structure names.
#pragma once

#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

inline constexpr std::size_t kMaxNameCharacters = 200;

/// kFailed for empty names, more than kMaxNameCharacters characters, control characters (including tabs and
/// newlines), and invalid UTF-8. The message contains the name; callers add the location.
[[nodiscard]] Result<void> check_structure_name(std::string_view name);

/// Normalized name for comparisons: trimmed, ASCII letters in lower case.
[[nodiscard]] std::string name_key(std::string_view name);

}  // namespace splatlas
