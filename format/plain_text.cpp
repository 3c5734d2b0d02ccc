#include "format/plain_text.h"

#include <cstdint>

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

namespace splatlas {
namespace {

/// Those of eight bits, too: terminals obey them.
bool is_control(std::uint32_t c) {
  return (c < 0x20 && c != '\n' && c != '\t') || (c >= 0x7f && c <= 0x9f);
}

/// Embeddings, overrides and isolates: with them a name reads as another one.
bool turns_text(std::uint32_t c) {
  return (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

}  // namespace

std::string fault_of_text(std::string_view text) {
  bool plain = true;  // most text is, and this loop is of vectors
  for (const char c : text) plain &= c >= ' ' && c <= '~';
  if (plain) return {};
  const auto* const invalid = utf8::find_invalid(text.begin(), text.end());
  for (const auto* next = text.begin(); next != invalid;) {
    const auto byte = next - text.begin();
    const std::uint32_t c = utf8::unchecked::next(next);
    if (is_control(c)) return fmt::format("has a control character (byte {}: U+{:04X})", byte, c);
    if (turns_text(c))
      return fmt::format("has a character that turns text around (byte {}: U+{:04X})", byte, c);
  }
  return invalid == text.end() ? "" : fmt::format("is not UTF-8 (byte {})", invalid - text.begin());
}

}  // namespace splatlas
