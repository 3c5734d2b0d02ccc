#include "format/system/ascii_text.h"

#include <algorithm>

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

namespace splatlas {
namespace {

/// The first character of `text`.
struct Character {
  std::size_t bytes = 1;
  bool valid = true;  ///< false for a byte that is not UTF-8
  std::uint32_t code = 0;
};

Character first_character(std::string_view text) {
  const auto* next = text.begin();
  try {
    const std::uint32_t code = utf8::next(next, text.end());
    return {static_cast<std::size_t>(next - text.begin()), true, code};
  } catch (const utf8::exception&) {
    return {1, false, static_cast<unsigned char>(text.front())};
  }
}

/// Consumes up to `max_bytes` bytes of whole characters from the start of `text`; returns them in printable
/// form.
std::string printable_start(std::string_view& text, std::size_t max_bytes) {
  std::string result;
  while (!text.empty()) {
    const Character c = first_character(text);
    if (c.bytes > max_bytes) break;
    if (!c.valid) {
      result += fmt::format("\\x{:02x}", c.code);
    } else {
      result +=
          c.code < 0x20 || is_control(c.code) || is_bidi_control(c.code) ? "?" : text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes);
    max_bytes -= c.bytes;
  }
  return result;
}

}  // namespace

std::string to_lower(std::string_view text) {
  std::string lowered(text);
  for (char& c : lowered) c = to_lower(c);
  return lowered;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return to_lower(x) == to_lower(y); });
}

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

std::string printable(std::string_view text) {
  return printable_start(text, text.size());
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxBytes = 80;
  const std::string start = printable_start(text, kMaxBytes);
  return '"' + start + (text.empty() ? "\"" : "...\"");
}

}  // namespace splatlas
