// Case-insensitive ASCII comparison, and escaping of text for messages.
#pragma once

#include <string>
#include <string_view>

namespace splatlas {

/// Converts ASCII letters to lower case; keeps all other bytes, including UTF-8.
[[nodiscard]] constexpr char to_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
[[nodiscard]] std::string to_lower(std::string_view text);

/// Compares, ignoring the case of ASCII letters.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

/// Makes text safe for one line of a terminal: replaces control and bidirectional formatting characters by
/// "?", and bytes that are not UTF-8 by "\xNN".
[[nodiscard]] std::string printable(std::string_view text);

/// Printable text in double quotes, truncated to 80 bytes with "...".
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace splatlas
