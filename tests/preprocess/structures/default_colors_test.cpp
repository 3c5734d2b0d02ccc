#include <gtest/gtest.h>

#include "format/text/ascii_text.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {
namespace {

/// A name and its colour, or "-", a line each.
constexpr std::string_view kNames =
#include "tests/preprocess/structures/anatomical_names.txt"
    ;

TEST(AnatomicalColor, FollowsTheLongestEntryOfWholeWords) {
  for (const std::string_view line : split(kNames, '\n')) {
    const std::size_t blank = line.rfind(' ');
    const std::optional<Rgb> color = anatomical_color(line.substr(0, blank), {});
    EXPECT_EQ(color ? to_hex(*color) : "-", line.substr(blank + 1)) << line;
  }
  const std::vector<Term> liver{{"modifier SNOMED", "7771000"}, {"SNOMED", "10200004"}};
  EXPECT_EQ(anatomical_color("x", liver), (Rgb{0x8e, 0x4d, 0x37}));
}

}  // namespace
}  // namespace splatlas
