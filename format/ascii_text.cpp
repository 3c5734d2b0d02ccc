#include "format/ascii_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace splatlas {
namespace {

/// The first character of `text`.
struct Character {
  std::size_t bytes = 1;
  bool valid = true;  ///< UTF-8 (RFC 3629); else it is one byte
  char32_t code = 0;
};

Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return {1, true, lead};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {1, false, lead};
  char32_t code = lead & (0x7fu >> bytes);
  for (const char c : text.substr(1, bytes - 1)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0u) != 0x80u) return {1, false, lead};
    code = code << 6 | (byte & 0x3fu);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (overlong || surrogate || code > 0x10ffff) return {1, false, lead};
  return {bytes, true, code};
}

/// With what is left when `most` bytes were taken, cut between characters.
std::string printable_start(std::string_view& text, std::size_t most) {
  std::string result;
  while (!text.empty()) {
    const Character c = first_character(text);
    if (c.bytes > most) break;
    const bool control = c.code < 0x20 || (c.code >= 0x7f && c.code < 0xa0);
    if (!c.valid) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned>(c.code));
    } else {
      result += control ? "?" : text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes);
    most -= c.bytes;
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

std::string printable(std::string_view text) {
  return printable_start(text, text.size());
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  const std::string start = printable_start(text, kLongest);
  return '"' + start + (text.empty() ? "\"" : "...\"");
}

}  // namespace splatlas
