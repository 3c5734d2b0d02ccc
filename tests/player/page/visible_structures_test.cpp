// Visible structures, free space, line breaks, scale bars and directions.
#include "player/page/visible_structures.h"

#include <cmath>

#include <gmock/gmock.h>

#include "player/camera.h"
#include "player/page/page_layout.h"
#include "player/page/place_labels.h"
#include "tests/player/page/label_scene.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

TEST(VisibleStructures, HaveDeepAnchors) {
  DiscScene discs({100, 80});
  discs.add(3, 40, 40, 30);
  discs.add(9, 60, 40, 20);
  const auto structures = visible_structures(discs.grid);
  ASSERT_EQ(structures.size(), 2u);
  EXPECT_EQ(structures[1].structure, 9u);
  // The sampled centre is within a pixel of the disc's, and its area within the pixels of the border.
  EXPECT_NEAR(structures[1].anchor.x, 60, 2);
  EXPECT_NEAR(structures[1].anchor.y, 40, 2);
  EXPECT_NEAR(structures[1].pixels, 3.14159 * 400, 2 * 3.14159 * 20);
  EXPECT_LT(structures[0].anchor.x, 40);  // the rest of the first disc is a crescent
}

TEST(VisibleStructures, AreSampledWithinABound) {
  DiscScene discs({400, 300});
  discs.add(1, 200, 150, 100);
  int picks = 0;
  const auto at = [&](double x, double y) {
    ++picks;
    return discs.grid.ids[static_cast<std::size_t>(y) * 400 + static_cast<std::size_t>(x)];
  };
  const IdGrid grid = sample_structures(discs.picture, at, 1200);
  EXPECT_EQ(grid.columns, 40);
  EXPECT_EQ(grid.rows, 30);
  EXPECT_NEAR(picks, 1200 * 3.14159 / 12, 20);  // pixels of the background are not picked
  const auto structures = visible_structures(grid);
  ASSERT_EQ(structures.size(), 1u);
  EXPECT_NEAR(structures[0].pixels, 3.14159 * 1e4, 2000);
  EXPECT_NEAR(structures[0].anchor.x, 200, 20);
}

TEST(FreeSpace, AgreesWithThePixels) {
  DiscScene discs({90, 70});
  discs.add(1, 30, 30, 8);
  const FreeSpace space(discs.picture);
  EXPECT_TRUE(space.is_free({40, 40, 90, 70}));
  EXPECT_FALSE(space.is_free({37, 29, 60, 31}));
  EXPECT_TRUE(space.is_free({-50, -50, 0, 0}));
  EXPECT_TRUE(space.is_free({0, 0, 90, 22}));
  EXPECT_FALSE(space.is_free({0, 0, 90, 23}));
  ASSERT_TRUE(space.content());
  EXPECT_EQ(space.content()->left, 22);
  EXPECT_EQ(space.content()->bottom, 38);
}

TEST(WrapText, BreaksAtBlanksAndInLongWords) {
  const auto width = [](std::string_view text) { return static_cast<double>(text.size()); };
  EXPECT_THAT(wrap_text("one two three", 7, width), ElementsAre("one two", "three"));
  EXPECT_THAT(wrap_text("one  two", 100, width), ElementsAre("one two"));
  EXPECT_THAT(wrap_text("abcdefgh ij", 5, width), ElementsAre("abcde", "fgh", "ij"));
  EXPECT_THAT(wrap_text("\xc3\xa4\xc3\xb6", 1, width), ElementsAre("\xc3\xa4", "\xc3\xb6"));
  EXPECT_THAT(wrap_text("", 5, width), ElementsAre());
  EXPECT_THAT(balanced_lines("one two three f", 13, width), ElementsAre("one two", "three f"));
  EXPECT_THAT(balanced_lines("one", 2, width), ElementsAre("on", "e"));
  EXPECT_THAT(balanced_lines("three one", 5, width), ElementsAre("three", "one"));
  EXPECT_EQ(shortened_text("abcdef", 6, width), "abcdef");
  EXPECT_EQ(shortened_text("abcdefghi", 6, width), "abc\xe2\x80\xa6");
}

TEST(ScaleBar, HasStepsOfOneTwoAndFive) {
  for (const auto& [most, length] :
       {std::pair(49.9, 20.0), {50, 50}, {100, 100}, {1.7, 1}, {0.7, 0.5}, {0.0021, 0.002}, {0, 0}, {-1, 0}})
    EXPECT_EQ(scale_bar_mm(most), length);
}

TEST(DirectionLetters, FollowTheCompass) {
  for (const auto& [direction, letters] : {std::pair<Vec3, const char*>{{1, 0, 0}, "L"},
                                           {{-1, 0, 0}, "R"},
                                           {{0, 1, 0}, "P"},
                                           {{0, -1, 0}, "A"},
                                           {{0, 0, 1}, "S"},
                                           {{0, 0, -1}, "I"},
                                           {{0.8, -0.6, 0}, "LA"},
                                           {{0.6, -0.8, 0}, "AL"}})
    EXPECT_EQ(direction_letters(direction), letters);
  const double near = std::sin(20 * 3.14159265358979 / 180);
  EXPECT_EQ(direction_letters({near, 0, std::sqrt(1 - near * near)}), "S");
  const auto oblique = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    return direction_letters({std::cos(angle), -std::sin(angle), 0});
  };
  EXPECT_EQ(oblique(22) + " " + oblique(23) + " " + oblique(67) + " " + oblique(68), "L LA AL A");
  EXPECT_EQ(direction_letters({0.57735, 0.57735, 0.57735}), "LPS");
}

}  // namespace
}  // namespace splatlas
