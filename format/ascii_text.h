// Names without regard to case, and names inside messages.
#pragma once

#include <string>
#include <string_view>

namespace splatlas {

/// ASCII letters lowered; every other byte, UTF-8 included, as it is.
[[nodiscard]] constexpr char to_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
[[nodiscard]] std::string to_lower(std::string_view text);

/// Equal but for the case of ASCII letters.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

/// In double quotes, fit for a one-line message: control characters become "?", all beyond 80 bytes "...".
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace splatlas
