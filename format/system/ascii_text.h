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

/// Fit for one line of a terminal: control characters become "?", bytes that are not UTF-8 "\\xNN".
[[nodiscard]] std::string printable(std::string_view text);

/// In double quotes, printable, and all beyond 80 bytes "...".
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace splatlas
