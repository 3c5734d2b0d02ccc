#include "format/system/ascii_text.h"

#include <gtest/gtest.h>

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

TEST(AsciiText, BytesThatAreNotUtf8AreEscaped) {
  const std::string valid = "\xc3\xa4 \xe2\x82\xac \xf0\x9f\xa7\xa0 \xf4\x8f\xbf\xbf \xed\x9f\xbf";
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

}  // namespace
}  // namespace splatlas
