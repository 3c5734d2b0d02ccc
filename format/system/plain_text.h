// Detection of characters that are unsafe to display.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace splatlas {

/// C0 and C1 control characters and delete, except line feed and tab. Terminals interpret both sets.
[[nodiscard]] constexpr bool is_control(std::uint32_t c) {
  return (c < 0x20 && c != '\n' && c != '\t') || (c >= 0x7f && c <= 0x9f);
}
/// Bidirectional embeddings, overrides and isolates, which can disguise names.
[[nodiscard]] constexpr bool is_bidi_control(std::uint32_t c) {
  return (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// Describes the first fault of a text, as the end of a sentence: invalid UTF-8, is_control() or
/// is_bidi_control().
/// "" for valid text.
[[nodiscard]] std::string fault_of_text(std::string_view text);

}  // namespace splatlas
