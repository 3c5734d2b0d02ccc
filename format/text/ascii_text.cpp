#include "format/text/ascii_text.h"

#include <sstream>

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

/// First and last characters of ranges; sorted.
using CharacterRange = std::pair<std::uint32_t, std::uint32_t>;
constexpr std::array<CharacterRange, 21> kUnsafeRanges{{
#include "format/text/unsafe_characters.txt"
}};

/// Consumes up to `max_bytes` bytes of whole characters from the start of `text`; returns them with unsafe
/// characters replaced. `kept` is shown although unsafe.
std::string printable_start(std::string_view& text, std::size_t max_bytes, std::string_view kept = {}) {
  std::string result;
  while (!text.empty()) {
    const Character c = first_character(text);
    if (c.bytes > max_bytes) break;
    if (!c.valid) {
      result += fmt::format("\\x{:02x}", c.code);
    } else {
      const bool is_kept = c.bytes == 1 && kept.find(text.front()) != std::string_view::npos;
      result += is_unsafe_to_show(c.code) && !is_kept ? "?" : text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes);
    max_bytes -= c.bytes;
  }
  return result;
}

/// \uXXXX, or a surrogate pair of them.
std::string json_escape(std::uint32_t c) {
  if (c < 0x10000) return fmt::format("\\u{:04x}", c);
  c -= 0x10000;
  return fmt::format("\\u{:04x}\\u{:04x}", 0xd800 + (c >> 10), 0xdc00 + (c & 0x3ff));
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

bool is_unsafe_to_show(std::uint32_t c) {
  const auto* const range = std::ranges::lower_bound(kUnsafeRanges, c, {}, &CharacterRange::second);
  const bool is_noncharacter = (c & 0xfffe) == 0xfffe;
  return is_noncharacter || (range != kUnsafeRanges.end() && c >= range->first);
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

std::string printable_lines(std::string_view text) {
  return printable_start(text, text.size(), "\n\t");
}

std::string escaped_json(std::string_view document) {
  std::string result;
  while (!document.empty()) {
    const Character c = first_character(document);
    if (!c.valid) {
      result += "\xef\xbf\xbd";  // replacement character
    } else if (is_unsafe_to_show(c.code) && c.code != '\n' && c.code != '\t') {
      result += json_escape(c.code);
    } else {
      result += document.substr(0, c.bytes);
    }
    document.remove_prefix(c.bytes);
  }
  return result;
}

std::string escaped_markup(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

std::string shortened(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return std::string(text);
  while (max_bytes > 0 && (static_cast<unsigned char>(text[max_bytes]) & 0xc0u) == 0x80u) --max_bytes;
  return std::string(text.substr(0, max_bytes)) + "\xe2\x80\xa6";
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxBytes = 80;
  const std::string start = printable_start(text, kMaxBytes);
  return '"' + start + (text.empty() ? "\"" : "...\"");
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::string one_line(const std::string& message, const std::string& otherwise) {
  std::istringstream words(message);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  line.erase(line.find_last_not_of(" .") + 1);
  return line.empty() ? otherwise : line;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t start = 0;;) {
    const std::size_t end = text.find(separator, start);
    parts.push_back(trimmed(text.substr(start, end == std::string_view::npos ? end : end - start)));
    if (end == std::string_view::npos) return parts;
    start = end + 1;
  }
}

}  // namespace splatlas
