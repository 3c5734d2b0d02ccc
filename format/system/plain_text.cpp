#include "format/system/plain_text.h"

#include <cstdint>

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

namespace splatlas {
std::string fault_of_text(std::string_view text) {
  bool plain = true;  // fast path for ASCII; the loop vectorizes
  for (const char c : text) plain &= c >= ' ' && c <= '~';
  if (plain) return {};
  const auto* const invalid = utf8::find_invalid(text.begin(), text.end());
  for (const auto* next = text.begin(); next != invalid;) {
    const auto byte = next - text.begin();
    const std::uint32_t c = utf8::unchecked::next(next);
    if (is_control(c)) return fmt::format("has a control character (byte {}: U+{:04X})", byte, c);
    if (is_bidi_control(c))
      return fmt::format("has a bidirectional control character (byte {}: U+{:04X})", byte, c);
  }
  return invalid == text.end() ? "" : fmt::format("is not UTF-8 (byte {})", invalid - text.begin());
}

}  // namespace splatlas
