// What a structure may be called.
#pragma once

#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

inline constexpr std::size_t kMaxNameCharacters = 200;

/// Refuses an empty name, one of more than kMaxNameCharacters, control characters (newlines, tabs), and what
/// is not UTF-8. The message (kFailed) holds the name; callers say where it stands.
[[nodiscard]] Result<void> check_structure_name(std::string_view name);

/// Equal for names that lookups cannot tell apart: without blanks at the ends and without regard to case.
[[nodiscard]] std::string name_key(std::string_view name);

}  // namespace splatlas
