#include "format/plain_text.h"

#include <cstddef>

#include <fmt/format.h>

namespace splatlas {
namespace {

/// Length of the UTF-8 sequence that begins `text`, by the table of well-formed sequences of the Unicode
/// standard (3.9, table 3-7); 0 when it is not one.
std::size_t utf8_sequence(std::string_view text) {
  const auto at = [&](std::size_t n) { return n < text.size() ? static_cast<unsigned char>(text[n]) : 0u; };
  const unsigned lead = at(0);
  const auto tail = [&](std::size_t n) { return at(n) >= 0x80 && at(n) <= 0xbf; };
  if (lead < 0x80) return 1;
  if (lead >= 0xc2 && lead <= 0xdf) return tail(1) ? 2 : 0;
  if (lead >= 0xe0 && lead <= 0xef) {
    const unsigned low = lead == 0xe0 ? 0xa0 : 0x80, high = lead == 0xed ? 0x9f : 0xbf;
    return at(1) >= low && at(1) <= high && tail(2) ? 3 : 0;
  }
  if (lead >= 0xf0 && lead <= 0xf4) {
    const unsigned low = lead == 0xf0 ? 0x90 : 0x80, high = lead == 0xf4 ? 0x8f : 0xbf;
    return at(1) >= low && at(1) <= high && tail(2) && tail(3) ? 4 : 0;
  }
  return 0;
}

/// Whether a sequence of UTF-8 is one of the characters that turn text around: embeddings, overrides and
/// isolates (U+202A to U+202E, U+2066 to U+2069). With them a name reads as another one.
bool turns_text(std::string_view sequence) {
  return (sequence >= "\xe2\x80\xaa" && sequence <= "\xe2\x80\xae") ||
         (sequence >= "\xe2\x81\xa6" && sequence <= "\xe2\x81\xa9");
}

}  // namespace

std::string fault_of_text(std::string_view text) {
  bool plain = true;  // most text is, and this loop is of vectors
  for (const char c : text) plain &= c >= ' ' && c <= '~';
  if (plain) return {};
  for (std::size_t n = 0; n < text.size();) {
    const std::size_t length = utf8_sequence(text.substr(n));
    if (length == 0) return fmt::format("is not UTF-8 (byte {})", n);
    const unsigned char c = static_cast<unsigned char>(text[n]);
    if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f)
      return fmt::format("has a control character (byte {} is {:#04x})", n, c);
    const std::string_view sequence = text.substr(n, length);
    if (sequence >= "\xc2\x80" && sequence <= "\xc2\x9f") {  // those of eight bits, which terminals obey, too
      return fmt::format("has a control character (byte {} begins U+{:04X})", n,
                         static_cast<unsigned char>(sequence[1]));
    }
    if (turns_text(sequence)) return fmt::format("has a character that turns text around (byte {})", n);
    n += length;
  }
  return {};
}

}  // namespace splatlas
