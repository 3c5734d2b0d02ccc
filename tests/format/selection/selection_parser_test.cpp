#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/content/selection.h"
#include "tests/support/fails_with.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

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
    const auto terms = value_or_throw(parse_selection(text));
    EXPECT_TRUE(terms.empty());
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

TEST(ParseSelection, ReadsLabels) {
  for (const auto& [text, label] : {std::pair<const char*, std::int64_t>{"#17", 17},
                                    {" #0 ", 0},
                                    {"#-5", -5},
                                    {"#007", 7},
                                    {"#9223372036854775807", INT64_MAX},
                                    {"#-9223372036854775808", INT64_MIN}}) {
    const SelectionTerm term = only_term(text);
    EXPECT_EQ(term.target, TermTarget::kLabel) << text;
    EXPECT_EQ(term.label, label);
  }
  const auto terms = value_or_throw(parse_selection("#1:surface(opacity=0.5)+#2 - #3:volume-#4"));
  ASSERT_EQ(terms.size(), 4u);
  EXPECT_EQ(terms[0].name, "#1");
  EXPECT_EQ(terms[0].mode, DrawMode::kSurface);
  EXPECT_EQ(terms[0].opacity, 0.5f);
  EXPECT_EQ(terms[2].label, 3);
  EXPECT_TRUE(terms[3].remove);
  EXPECT_EQ(only_term("\"#17\"").target, TermTarget::kName);
  EXPECT_EQ(only_term("\"#17\"").name, "#17");
}

TEST(ParseSelection, ReadsTheRest) {
  for (const char* text : {"rest", "REST", " Rest:surface(opacity=0.1)"}) {
    EXPECT_EQ(only_term(text).target, TermTarget::kRest) << text;
  }
  for (const char* text : {"\"rest\"", "rest*", "Brain/rest", "rests", "\"Rest of brain\"", "a.rest"}) {
    EXPECT_EQ(only_term(text).target, TermTarget::kName) << text;
  }
}

TEST(ParseSelection, OptionsHaveValues) {
  EXPECT_THAT(parse_selection("A(color)"),
              FailsWith(ErrorCode::kUsage, HasSubstr("expected \"=\" after color")));
  EXPECT_THAT(parse_selection("A(ghost=1)"),
              FailsWith(ErrorCode::kUsage, HasSubstr("expected \",\" or \")\" after an option")));
  EXPECT_THAT(parse_selection("A(ghost,ghost)"),
              FailsWith(ErrorCode::kUsage, HasSubstr("ghost is given twice")));
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
  EXPECT_FALSE(only_term("A(opacity=1)").ghost);
  EXPECT_TRUE(only_term("A:surface(Ghost , opacity=1)").ghost);
  EXPECT_EQ(only_term("A(ghost)").mode, DrawMode::kSurface);
  EXPECT_EQ(only_term("A(opacity=.25)").opacity, 0.25f);
}

TEST(ParseSelection, ReadsTransferFunctions) {
  const SelectionTerm plain = only_term("A");
  EXPECT_EQ(plain.profile, std::nullopt);
  EXPECT_EQ(plain.low, std::nullopt);
  EXPECT_EQ(plain.high, std::nullopt);
  EXPECT_EQ(plain.curve, nullptr);
  const SelectionTerm ramp = only_term("A(Profile=HARD, low=-12.5, high = 3e2)");
  EXPECT_EQ(ramp.profile, TransferProfile::kHard);
  EXPECT_EQ(ramp.low, -12.5);
  EXPECT_EQ(ramp.high, 300.0);
  EXPECT_EQ(only_term("A(profile=soft)").profile, TransferProfile::kSoft);
  EXPECT_EQ(only_term("A(profile=thin)").profile, TransferProfile::kThin);

  const SelectionTerm curve = only_term("A(curve=-20:0/40.5:1:0.25/1e3:1e-3:0 , opacity=1)");
  ASSERT_NE(curve.curve, nullptr);
  EXPECT_EQ(*curve.curve, (TransferCurve{{{-20, 0, 1}, {40.5, kMaxVolumeOpacity, 0.25f}, {1000, 1e-3f, 0}}}));
  EXPECT_EQ(*only_term("A(curve=7:0.5)").curve, (TransferCurve{{{7, 0.5f, 1}}}));
}

TEST(ParseSelection, TakesAsManyPointsAsACurveMayHave) {
  std::string text = "A(curve=0:0.5";
  for (std::size_t n = 1; n < kMaxTransferPoints; ++n) text += fmt::format("/{}:0.5", n);
  EXPECT_EQ(only_term(text + ")").curve->points.size(), kMaxTransferPoints);
  EXPECT_THAT(
      message_of(parse_selection(text + "/1000:0.5)")),
      AllOf(HasSubstr("257 points: at most 256"), HasSubstr(fmt::format(", column {}: ", text.size() + 2))));
}

TEST(ParseSelection, SignsNeedNoBlanks) {
  const auto terms = value_or_throw(parse_selection("A+B-C:surface+D"));
  ASSERT_EQ(terms.size(), 4u);
  EXPECT_EQ(terms[1].name, "B");
  EXPECT_TRUE(terms[2].remove);
  EXPECT_EQ(terms[2].mode, DrawMode::kSurface);
  EXPECT_FALSE(terms[3].remove);
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
      {"A(profile=)", 11, "\"\" is not a profile: write soft, thin or hard"},
      {"A(profile=sof)", 11, "\"sof\" is not a profile"},
      {"A(profile=soft,profile=hard)", 16, "profile is given twice"},
      {"A(low=)", 7, "low \"\" is not a grey value"},
      {"A(low=x)", 7, "low \"x\" is not a grey value"},
      {"A(low=inf)", 7, "low \"inf\" is not a grey value"},
      {"A(high=nan)", 8, "high \"nan\" is not a grey value"},
      {"A(high=1e999)", 8, "high \"1e999\" is not a grey value"},
      {"A(high=+4)", 8, "high \"+4\" is not a grey value"},
      {"A(low=1,low=2)", 9, "low is given twice"},
      {"A(high=1,high=2)", 10, "high is given twice"},
      {"A(low=5,high=5)", 14, "low 5 must be below high 5"},
      {"A(high=-5,low=4)", 15, "low 4 must be below high -5"},
      {"A(curve=)", 9, "\"\" is not a point"},
      {"A(curve=5)", 9, "\"5\" is not a point of a curve: write grey:opacity"},
      {"A(curve=5:)", 9, "\"5:\" is not a point"},
      {"A(curve=:0.5)", 9, "\":0.5\" is not a point"},
      {"A(curve=5:0.5:)", 9, "is not a point"},
      {"A(curve=5:0.5:1:1)", 9, "is not a point"},
      {"A(curve=5:0.5x)", 9, "is not a point"},
      {"A(curve=nan:0.5)", 9, "is not a point"},
      {"A(curve=5:0.5/)", 15, "\"\" is not a point"},
      {"A(curve=5:0.5//9:0.5)", 15, "\"\" is not a point"},
      {"A(curve=5:0.5/ 9:0.5)", 15, "\"\" is not a point"},
      {"A(curve=5:0.5/5:0.5)", 15, "grey value 5 must be above 5, the point before"},
      {"A(curve=5:0,curve=5:0)", 13, "curve is given twice"},
      {"A(curve=5:0,low=5)", 17, "low does not go with curve"},
      {"A(curve=5:0,high=5)", 18, "high does not go with curve"},
      {"A(curve=5:0,profile=soft)", 21, "profile does not go with curve"},
      {"A(low=5,curve=5:0)", 15, "curve does not go with profile, low or high"},
      {"A - B(low=5)", 6, "a removal takes no options; quote a name that holds a \"-\""},
      {"A - B(opacity=0.5)", 6, "a removal takes no options; quote a name that holds a \"-\""},
      {"A)", 2, "expected \"+\" or \"-\""},
      {"#", 1, "\"#\" is not a label: write # and a whole number"},
      {"A + #x", 5, "\"#x\" is not a label"},
      {"#1.5", 1, "\"#1.5\" is not a label"},
      {"#1a", 1, "\"#1a\" is not a label"},
      {"#-", 1, "\"#-\" is not a label"},
      {"#--1", 1, "\"#-\" is not a label"},
      {"# 1", 1, "\"#\" is not a label"},
      {"#9223372036854775808", 1, "is not a label"},
      {"#1#2", 3, "expected \"+\" or \"-\""},
      {"A - rest", 5, "the rest cannot be removed"},
      {"A - Rest:surface", 5, "the rest cannot be removed"},
  };
  for (const auto& [text, column, part] : faults) {
    const std::string at = fmt::format(", column {}: ", column);
    EXPECT_THAT(parse_selection(text), FailsWith(ErrorCode::kUsage, AllOf(HasSubstr(at), HasSubstr(part))))
        << text;
  }
}

TEST(ParseSelection, MessagesStayOnOneLine) {
  EXPECT_THAT(message_of(parse_selection("A:\n\x1b + B\n\n\n")), testing::Not(HasSubstr("\n")));
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
