#include <gtest/gtest.h>

#include "format/text/ascii_text.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {
namespace {

/// A name and its colour, or "-", a line each.
constexpr std::string_view kNames =
#include "tests/preprocess/structures/anatomical_names.txt"
    ;

TEST(DefaultColors, OfAnatomyFollowTheLongestEntryOfWholeWords) {
  for (const std::string_view line : split(kNames, '\n')) {
    const std::size_t blank = line.rfind(' ');
    const Rgb color = DefaultColors().next(line.substr(0, blank), {}, 7);
    EXPECT_EQ(color == default_color(7) ? "-" : to_hex(color), line.substr(blank + 1)) << line;
  }
}

/// Of 60 ribs, each differs; the first has the colour of the table, and none is darker by more than a fifth.
TEST(DefaultColors, AreDistinct) {
  DefaultColors colors;
  std::set<std::string> ribs;
  for (std::size_t n = 0; n < 60; ++n) {
    const Rgb rib = colors.next("rib", {}, n);
    EXPECT_EQ(rib == (Rgb{0xe6, 0xdc, 0xc3}), n == 0);
    EXPECT_GE(rib.r, 184);  // 0.8 * 0xe6
    EXPECT_TRUE(ribs.insert(to_hex(rib)).second);
  }
  EXPECT_EQ(colors.next("Label 7", {}, 5), default_color(5));
  EXPECT_EQ(colors.next("x", std::vector{Term{"modifier SNOMED", "7771000"}, {"SNOMED", "10200004"}}, 0),
            (Rgb{0x8e, 0x4d, 0x37}));
}

}  // namespace
}  // namespace splatlas
