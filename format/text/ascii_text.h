// Case-insensitive ASCII comparison, parsing of numbers, detection of characters that are unsafe to display,
// and escaping of text for messages.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"  // printable()

namespace splatlas {

[[nodiscard]] constexpr bool is_ascii_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Converts ASCII letters to lower case; keeps all other bytes, including UTF-8.
[[nodiscard]] constexpr char to_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
[[nodiscard]] std::string to_lower(std::string_view text);

/// Compares, ignoring the case of ASCII letters.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

/// Parses text that is exactly one number, possibly infinite or not a number; no blanks, no "+".
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Parses exactly n numbers with commas between them, each as by parse_number().
template <std::size_t n>
[[nodiscard]] std::optional<std::array<double, n>> parse_numbers(std::string_view text) {
  std::array<double, n> numbers{};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t end = i + 1 < n ? text.find(',') : text.size();
    const auto number = parse_number<double>(text.substr(0, end));
    if (!number || end == std::string_view::npos) return std::nullopt;
    numbers[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

/// C0 and C1 control characters and delete, except line feed and tab. Terminals interpret both sets.
[[nodiscard]] constexpr bool is_control(std::uint32_t c) {
  return (c < 0x20 && c != '\n' && c != '\t') || (c >= 0x7f && c <= 0x9f);
}
/// Bidirectional embeddings, overrides and isolates, which can disguise names.
[[nodiscard]] constexpr bool is_bidi_control(std::uint32_t c) {
  return (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// Characters that change a terminal, reorder text, or show nothing: control characters with line feed and
/// tab, line and paragraph separators, interlinear annotations, noncharacters, and Unicode's properties
/// Bidi_Control and Default_Ignorable_Code_Point (zero-width space, variation selectors, tags). Not the
/// joiners U+200C and U+200D, which Persian and Indic words need.
[[nodiscard]] bool is_unsafe_to_show(std::uint32_t c);

/// Describes the first fault of a text, as the end of a sentence: invalid UTF-8, is_control() or
/// is_bidi_control(). "" for valid text.
[[nodiscard]] std::string fault_of_text(std::string_view text);

/// printable(), but keeps line feeds and tabs: for layout of the program's own.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// Escapes is_unsafe_to_show() in a JSON document as \uXXXX, with surrogate pairs. Keeps the document's line
/// feeds and tabs, which are outside its strings. Replaces bytes that are not UTF-8 by U+FFFD.
[[nodiscard]] std::string escaped_json(std::string_view document);

/// Escapes the characters & < > " of XML and HTML.
[[nodiscard]] std::string escaped_markup(std::string_view text);

/// The text; a longer one than `max_bytes` is cut behind whole characters, with an ellipsis.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t max_bytes);

/// Printable text in double quotes, truncated to 80 bytes with "...".
[[nodiscard]] std::string in_quotes(std::string_view text);

[[nodiscard]] std::string_view trimmed(std::string_view text);
/// A library's message as one line without a full stop; `otherwise` if there is none.
[[nodiscard]] std::string one_line(const std::string& message, const std::string& otherwise);
/// Splits at `separator` into trimmed parts; "a,,b" has three. The parts refer to `text`.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
std::vector<std::string_view> split(std::string&& text, char separator) = delete;

}  // namespace splatlas
