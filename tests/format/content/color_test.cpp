#include "format/content/color.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

TEST(Color, ParsesLongAndShortForms) {
  EXPECT_EQ(to_hex({255, 136, 9}), "#ff8809");
  EXPECT_EQ(*parse_color("#ff8800"), (Rgb{255, 136, 0}));
  EXPECT_EQ(*parse_color("#FF88aB"), (Rgb{255, 136, 171}));
  EXPECT_EQ(*parse_color("#f80"), (Rgb{255, 136, 0}));
  EXPECT_EQ(*parse_color("#19C"), (Rgb{0x11, 0x99, 0xcc}));
}

TEST(Color, RefusesEverythingElse) {
  for (const char* text : {"", "#", "ff8800", "#ff880", "#ff88000", "#ff88gg", "#ggg", "#-10000", "red",
                           "##fffff", "#ff 800", "#ffff", " #ff8800", "ff80", "#0g0000", "#f0000g"}) {
    EXPECT_THAT(parse_color(text), FailsWith(ErrorCode::kUsage, HasSubstr("#rrggbb"))) << text;
  }
}

RC_GTEST_PROP(Color, HexRoundTrip, (std::uint8_t r, std::uint8_t g, std::uint8_t b)) {
  const Rgb color{r, g, b};
  RC_ASSERT(*parse_color(to_hex(color)) == color);
}

TEST(Color, LinearLightFollowsTheStandard) {
  EXPECT_EQ(srgb_to_linear(0), 0.0f);
  EXPECT_EQ(srgb_to_linear(255), 1.0f);
  EXPECT_FLOAT_EQ(srgb_to_linear(10),
                  static_cast<float>(10 / 255.0 / 12.92));  // the straight part ends at 10.3
  EXPECT_NEAR(srgb_to_linear(11), 0.0033465, 1e-7);
  EXPECT_NEAR(srgb_to_linear(128), 0.2158605, 1e-7);
  EXPECT_NEAR(srgb_to_linear(188), 0.5028865, 1e-7);
}

}  // namespace
}  // namespace splatlas
