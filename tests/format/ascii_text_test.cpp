#include "format/ascii_text.h"

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

}  // namespace
}  // namespace splatlas
