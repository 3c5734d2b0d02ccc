// Text that can be shown on any terminal and in any window.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace splatlas {

/// Control characters but line feed and tab; those of eight bits, too: terminals obey them.
[[nodiscard]] constexpr bool is_control(std::uint32_t c) {
  return (c < 0x20 && c != '\n' && c != '\t') || (c >= 0x7f && c <= 0x9f);
}
/// Embeddings, overrides and isolates: with them a name reads as another one.
[[nodiscard]] constexpr bool turns_text(std::uint32_t c) {
  return (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// What is wrong with a text that an atlas may not have, as the end of a sentence; "" for UTF-8 without
/// control characters but line feed and tab, and without characters that turn text around.
[[nodiscard]] std::string fault_of_text(std::string_view text);

}  // namespace splatlas
