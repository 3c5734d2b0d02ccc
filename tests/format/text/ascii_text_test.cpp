#include "format/text/ascii_text.h"

#include <iterator>

#include <gtest/gtest.h>
#include <utf8cpp/utf8.h>

namespace splatlas {
namespace {

TEST(AsciiText, LowersAsciiLettersOnly) {
  EXPECT_EQ(to_lower("AbZ@[`{09"), "abz@[`{09");
  EXPECT_EQ(to_lower("\xc3\x84"), "\xc3\x84");  // A with dots, in UTF-8
}

TEST(AsciiText, ComparesWithoutCase) {
  EXPECT_TRUE(equal_ignoring_case("Left Hemisphere", "lEFT hEMISPHERE"));
  EXPECT_TRUE(equal_ignoring_case("", ""));
  EXPECT_FALSE(equal_ignoring_case("left", "left "));
  EXPECT_FALSE(equal_ignoring_case("left", "lefu"));
  EXPECT_FALSE(equal_ignoring_case("@", "`"));  // 32 apart, as letters of either case are
}

TEST(AsciiText, QuotesFitOneLine) {
  EXPECT_EQ(in_quotes("Brain"), "\"Brain\"");
  EXPECT_EQ(in_quotes("a\nb\tc\x7f\x1b[0m"), "\"a?b?c??[0m\"");
  EXPECT_EQ(in_quotes(std::string(80, 'x')), '"' + std::string(80, 'x') + '"');
  EXPECT_EQ(in_quotes(std::string(81, 'x')), '"' + std::string(80, 'x') + "...\"");
}

TEST(AsciiText, QuotesCutBetweenUtf8Characters) {
  const std::string a_umlaut = "\xc3\xa4";
  std::string text(79, 'x');
  for (int n = 0; n < 3; ++n) text += a_umlaut;
  EXPECT_EQ(in_quotes(text), '"' + std::string(79, 'x') + "...\"");
}

TEST(AsciiText, ShortenedTextsKeepWholeCharacters) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc\xe2\x80\xa6");
  EXPECT_EQ(shortened("ab\xc3\xb6", 3), "ab\xe2\x80\xa6");
}

TEST(AsciiText, BytesThatAreNotUtf8AreEscaped) {
  const std::string valid = "\xc3\xa4 \xe2\x82\xac \xf0\x9f\xa7\xa0 \xf4\x8f\xbf\xbd \xed\x9f\xbf";
  EXPECT_EQ(printable(valid), valid);
  EXPECT_EQ(printable("a\xff"
                      "b"),
            "a\\xffb");
  EXPECT_EQ(printable("\xc3"), "\\xc3");                             // cut short
  EXPECT_EQ(printable("\xc3("), "\\xc3(");                           // no continuation
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // overlong, 2 bytes
  EXPECT_EQ(printable("\xe0\x80\xaf"), "\\xe0\\x80\\xaf");           // overlong, 3 bytes
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond the last character
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m\n"),
            "?31m?");  // control characters
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b\xe2\x81\xa6"),
            "a?b?");  // characters that turn text around
  EXPECT_EQ(in_quotes("Left \xe9"), "\"Left \\xe9\"");
}

/// Characters that a terminal interprets, that reorder text, or that show nothing.
constexpr std::array kUnsafe{
    0x00u,   0x07u,    0x09u,     0x0au,    0x0du,    0x1bu,    0x1fu,    0x7fu,   0x80u,   0x85u,   0x9bu,
    0x9fu,   0xadu,    0x34fu,    0x61cu,   0x115fu,  0x1160u,  0x180eu,  0x200bu, 0x200eu, 0x200fu, 0x2028u,
    0x2029u, 0x202au,  0x202bu,   0x202cu,  0x202du,  0x202eu,  0x2060u,  0x2064u, 0x2066u, 0x2067u, 0x2068u,
    0x2069u, 0x206fu,  0x3164u,   0xfe0fu,  0xfeffu,  0xffa0u,  0xfff9u,  0xfffbu, 0xfdd0u, 0xfdefu, 0xfffeu,
    0xffffu, 0x1fffeu, 0x10ffffu, 0xe0000u, 0xe0001u, 0xe0041u, 0xe007fu, 0xe01efu};
/// Visible neighbours of those.
constexpr std::array kSafe{0x20u,   0x7eu,   0xa0u,   0xacu,    0xaeu,    0x34eu,   0x61bu,
                           0x61du,  0x200au, 0x200cu, 0x200du,  0x2010u,  0x2027u,  0x202fu,
                           0x205fu, 0x2070u, 0x3163u, 0xfdffu,  0xfe10u,  0xfefcu,  0xff9fu,
                           0xffa1u, 0xfffcu, 0xfffdu, 0x1f9e0u, 0xdfffdu, 0xe1000u, 0x10fffdu};

std::string utf8_of(std::uint32_t c) {
  std::string text;
  utf8::append(static_cast<char32_t>(c), std::back_inserter(text));
  return text;
}

TEST(AsciiText, UnsafeCharactersAreReplaced) {
  for (const std::uint32_t c : kUnsafe) {
    EXPECT_TRUE(is_unsafe_to_show(c)) << std::hex << c;
    EXPECT_EQ(printable("a" + utf8_of(c) + "b"), "a?b") << std::hex << c;
    EXPECT_EQ(in_quotes("a" + utf8_of(c)), "\"a?\"") << std::hex << c;
  }
  for (const std::uint32_t c : kSafe) {
    EXPECT_FALSE(is_unsafe_to_show(c)) << std::hex << c;
    EXPECT_EQ(printable(utf8_of(c)), utf8_of(c)) << std::hex << c;
  }
}

TEST(AsciiText, LayoutKeepsLineFeedsAndTabsOnly) {
  EXPECT_EQ(printable_lines("a\tb\nc\r\x1b[K\xe2\x80\x8f"), "a\tb\nc??[K?");
}

TEST(AsciiText, JsonEscapesUnsafeCharacters) {
  EXPECT_EQ(escaped_json("{\n\t\"a\": \"\xc3\xa4\"\n}"), "{\n\t\"a\": \"\xc3\xa4\"\n}");
  EXPECT_EQ(escaped_json("\x7f\xc2\x9b\xe2\x80\x8f\xe2\x80\xa8"), "\\u007f\\u009b\\u200f\\u2028");
  EXPECT_EQ(escaped_json("\xf3\xa0\x81\x81\xf0\x9f\xbf\xbe"),
            "\\udb40\\udc41\\ud83f\\udffe");  // U+E0041, U+1FFFE
  EXPECT_EQ(escaped_json("a\xff"), "a\xef\xbf\xbd");
}

}  // namespace
}  // namespace splatlas
