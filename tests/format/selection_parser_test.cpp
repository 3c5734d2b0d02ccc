#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/selection.h"

namespace splatlas {
namespace {

using testing::HasSubstr;

SelectionTerm only_term(std::string_view text) {
  const auto terms = parse_selection(text);
  if (!terms || terms->size() != 1) {
    ADD_FAILURE() << text << ": " << (terms ? "not one term" : terms.error().message);
    return {};
  }
  return terms->front();
}

TEST(ParseSelection, NothingHasNoTerms) {
  for (const char* text : {"", " ", " \t\n "}) {
    const auto terms = parse_selection(text);
    ASSERT_TRUE(terms) << text;
    EXPECT_TRUE(terms->empty());
  }
}

TEST(ParseSelection, ReadsTheExampleOfTheManual) {
  const auto terms =
      parse_selection("\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*");
  ASSERT_TRUE(terms);
  ASSERT_EQ(terms->size(), 3u);
  EXPECT_EQ((*terms)[0].name, "Left hemisphere");
  EXPECT_EQ((*terms)[0].mode, DrawMode::kVolume);
  EXPECT_EQ((*terms)[0].column, 0u);
  EXPECT_EQ((*terms)[0].opacity, std::nullopt);
  EXPECT_EQ((*terms)[1].name, "Cerebellum");
  EXPECT_EQ((*terms)[1].mode, DrawMode::kSurface);
  EXPECT_EQ((*terms)[1].opacity, 0.5f);
  EXPECT_EQ((*terms)[1].column, 27u);
  EXPECT_FALSE((*terms)[1].remove);
  EXPECT_EQ((*terms)[2].name, "Vermis*");
  EXPECT_EQ((*terms)[2].mode, DrawMode::kOff);
  EXPECT_TRUE((*terms)[2].remove);
  EXPECT_EQ((*terms)[2].column, 61u);
}

TEST(ParseSelection, ReadsNames) {
  EXPECT_EQ(only_term("Brain/Cerebellum/Left").name, "Brain/Cerebellum/Left");
  EXPECT_EQ(only_term("Broca's_area.2").name, "Broca's_area.2");
  EXPECT_EQ(only_term("Gro\xc3\x9fhirn").name, "Gro\xc3\x9fhirn");
  EXPECT_EQ(only_term("\"a+b-c:d,(e)\"").name, "a+b-c:d,(e)");
  EXPECT_EQ(only_term("\"the \"\"old\"\" brain\"").name, "the \"old\" brain");
  EXPECT_EQ(only_term("\"back\\slash\"").name, "back\\slash");
  EXPECT_EQ(only_term("*").name, "*");
  EXPECT_EQ(only_term("37").name, "37");
}

TEST(ParseSelection, ReadsModesAndOptionsInAnyCaseAndSpacing) {
  EXPECT_EQ(only_term("A:both").mode, DrawMode::kBoth);
  EXPECT_EQ(only_term("A : SURFACE").mode, DrawMode::kSurface);
  EXPECT_EQ(only_term(" A\t:\nVolume ").mode, DrawMode::kVolume);
  const SelectionTerm term = only_term("A ( Color = #F80 , opacity =1e-2 )");
  EXPECT_EQ(term.color, (Rgb{255, 136, 0}));
  EXPECT_EQ(term.opacity, 0.01f);
  EXPECT_EQ(term.mode, DrawMode::kOff);
  EXPECT_EQ(only_term("A(opacity=1)").opacity, 1.0f);
  EXPECT_EQ(only_term("A(opacity=.25)").opacity, 0.25f);
}

TEST(ParseSelection, SignsNeedNoBlanks) {
  const auto terms = parse_selection("A+B-C:surface+D");
  ASSERT_TRUE(terms);
  ASSERT_EQ(terms->size(), 4u);
  EXPECT_EQ((*terms)[1].name, "B");
  EXPECT_TRUE((*terms)[2].remove);
  EXPECT_EQ((*terms)[2].mode, DrawMode::kSurface);
  EXPECT_FALSE((*terms)[3].remove);
}

TEST(ParseSelection, NamesTheColumnOfEachFault) {
  const std::vector<std::tuple<std::string, std::size_t, const char*>> faults{
      {"+ A", 1, "expected the name"},
      {"- A", 1, "nothing to remove from"},
      {"A +", 4, "expected the name"},
      {"A + + B", 5, "expected the name"},
      {"A - ", 5, "expected the name"},
      {"Left hemisphere", 6, "quote names"},
      {"A & B", 3, "expected \"+\" or \"-\""},
      {"A \"B\"", 3, "expected \"+\" or \"-\""},
      {"\"A", 1, "never closed"},
      {"A + \"B\"\"", 5, "never closed"},
      {"\"\"", 1, "empty"},
      {"A:", 3, "\"\" is not a mode"},
      {"A:solid", 3, "\"solid\" is not a mode"},
      {"A:off", 3, "\"off\" is not a mode"},
      {"A:volume:surface", 9, "expected \"+\" or \"-\""},
      {"A()", 3, "\"\" is not an option"},
      {"A(opacity=0.5", 14, "expected \",\" or \")\""},
      {"A(opacity=0.5,)", 15, "is not an option"},
      {"A(opacity 0.5)", 11, "expected \"=\""},
      {"A(alpha=0.5)", 3, "\"alpha\" is not an option"},
      {"A(opacity=)", 11, "opacity \"\""},
      {"A(opacity=0)", 11, "above 0 and at most 1"},
      {"A(opacity=-0.5)", 11, "above 0 and at most 1"},
      {"A(opacity=1.001)", 11, "above 0 and at most 1"},
      {"A(opacity=nan)", 11, "above 0 and at most 1"},
      {"A(opacity=inf)", 11, "above 0 and at most 1"},
      {"A(opacity=1e99)", 11, "above 0 and at most 1"},
      {"A(opacity=1e-99)", 11, "above 0 and at most 1"},
      {"A(opacity=0.5x)", 11, "above 0 and at most 1"},
      {"A(opacity=0,5)", 11, "above 0 and at most 1"},
      {"A(opacity=0.1,opacity=0.1)", 15, "opacity is given twice"},
      {"A(color=#fff,COLOR=#fff)", 14, "color is given twice"},
      {"A(color=red)", 9, "\"red\" is not a color"},
      {"A(color=#12345)", 9, "#rrggbb"},
      {"A - B(opacity=0.5)", 6, "a removal takes no options"},
      {"A)", 2, "expected \"+\" or \"-\""},
  };
  for (const auto& [text, column, part] : faults) {
    const auto terms = parse_selection(text);
    ASSERT_FALSE(terms) << text;
    EXPECT_EQ(terms.error().code, ErrorCode::kUsage) << text;
    EXPECT_THAT(terms.error().message, HasSubstr(fmt::format(", column {}: ", column))) << text;
    EXPECT_THAT(terms.error().message, HasSubstr(part)) << text;
  }
}

TEST(ParseSelection, MessagesStayOnOneLine) {
  const auto terms = parse_selection("A:\n\x1b + B\n\n\n");
  ASSERT_FALSE(terms);
  EXPECT_THAT(terms.error().message, testing::Not(HasSubstr("\n")));
  const auto lengthy = parse_selection(std::string(100'000, '+'));
  ASSERT_FALSE(lengthy);
  EXPECT_LT(lengthy.error().message.size(), 300u);
}

RC_GTEST_PROP(ParseSelection, QuotesHoldAnyName, (const std::string& name)) {
  RC_PRE(!name.empty());
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  text += "\"";
  const auto terms = parse_selection(text);
  RC_ASSERT(terms.has_value());
  RC_ASSERT(terms->size() == 1u);
  RC_ASSERT(terms->front().name == name);
}

RC_GTEST_PROP(ParseSelection, AnyTextIsReadOrRefused, ()) {
  const auto text = *rc::gen::container<std::string>(
      rc::gen::elementOf(std::string("aB1_./*'\"\"::  ++--(((),,=#=#0.5\n\xc3\xa4")));
  const auto terms = parse_selection(text);
  if (!terms) {
    RC_ASSERT(terms.error().code == ErrorCode::kUsage);
  } else {
    for (const SelectionTerm& term : *terms) RC_ASSERT(!term.name.empty());
  }
}

}  // namespace
}  // namespace splatlas
