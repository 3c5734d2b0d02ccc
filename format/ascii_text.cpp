#include "format/ascii_text.h"

#include <algorithm>

namespace splatlas {

std::string to_lower(std::string_view text) {
  std::string lowered(text);
  for (char& c : lowered) c = to_lower(c);
  return lowered;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return to_lower(x) == to_lower(y); });
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::size_t length = std::min(text.size(), kLongest);
  const auto is_continuation = [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; };
  if (length < text.size()) {
    while (length > 0 && is_continuation(text[length])) --length;  // whole UTF-8 characters only
  }
  std::string result = "\"";
  for (const char c : text.substr(0, length)) {
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    result += control ? '?' : c;
  }
  return result + (length < text.size() ? "...\"" : "\"");
}

}  // namespace splatlas
