#include <algorithm>
#include <array>
#include <tuple>

#include <gtest/gtest.h>

#include "player/page/visible_structures.h"

namespace splatlas {
namespace {

/// A white picture of 20 x 12 pixels: structure 1 on the left half, another number and depth on the right.
struct Halves {
  Picture picture{{20, 12}, std::vector<float>(std::size_t{4} * 20 * 12, 1.0f)};
  IdImage ids{{20, 12}, std::vector<StructureNumber>(std::size_t{20} * 12, 1)};
  DepthMap depths{{20, 12}, std::vector<float>(std::size_t{20} * 12, 5.0f)};

  Halves(StructureNumber number, float depth) {
    for (std::size_t n = 0; n < ids.numbers.size(); ++n) {
      if (n % 20 < 10) continue;
      ids.numbers[n] = number;
      depths.mm[n] = depth;
      if (number == 0) std::fill_n(&picture.rgba[4 * n], 4, 0.0f);
    }
  }
  void draw(double width = 1) { draw_outlines(picture, ids, depths, 1, width, picture); }
  [[nodiscard]] std::array<float, 4> at(int x) const { return picture.at(x, 6); }
};

TEST(DrawOutlines, HaveTheirWidthInPixels) {
  // The line lies between pixels 9 and 10. Three quarters of what it covers is dark.
  using Row = std::tuple<double, float, float>;
  for (const auto& [width, covered_9, covered_8] :
       {Row(0.2, 0.5f, 0), Row(1, 0.5f, 0), Row(1.5, 0.75f, 0), Row(2, 1, 0), Row(3, 1, 0.5f)}) {
    Halves halves(2, 5);
    halves.draw(width);
    for (const auto& [left, right, covered] :
         {std::tuple(9, 10, covered_9), {8, 11, covered_8}, {7, 12, 0.0f}}) {
      EXPECT_FLOAT_EQ(halves.at(left)[0], 1 - 0.75f * covered) << width << ' ' << left;
      EXPECT_FLOAT_EQ(halves.at(right)[0], 1 - 0.75f * covered) << width << ' ' << right;
    }
  }
}

TEST(DrawOutlines, DarkensFoldsButNoSlopes) {
  for (const int width : {1, 2}) {
    Halves fold(1, 6 + 12.0f * static_cast<float>(width)), slope(1, 4 + 12.0f * static_cast<float>(width));
    fold.draw(width);
    slope.draw(width);
    EXPECT_FLOAT_EQ(fold.at(9)[1], width == 1 ? 0.625f : 0.25f);
    EXPECT_FLOAT_EQ(slope.at(9)[1], 1);
  }
}

TEST(DrawOutlines, ReachIntoTheBackground) {
  for (const float rim : {1.0f, 0.5f}) {  // antialiased
    Halves halves(0, DepthMap::kBackground);
    for (std::size_t y = 0; y < 12; ++y) std::fill_n(&halves.picture.rgba[4 * (20 * y + 9)], 4, rim);
    halves.draw();
    EXPECT_FLOAT_EQ(halves.at(9)[0], 0.625f * rim);
    EXPECT_FLOAT_EQ(halves.at(10)[0], 0);
    EXPECT_FLOAT_EQ(halves.at(10)[3], 0.375f);
    EXPECT_FLOAT_EQ(halves.at(11)[3], 0);
  }
}

TEST(DrawOutlines, LeaveTranslucentStructuresAlone) {
  for (const float opacity : {0.9f, 0.96f}) {
    Halves halves(2, 5);
    for (float& value : halves.picture.rgba) value *= opacity;
    halves.draw();
    EXPECT_EQ(halves.at(9)[0]<opacity - 0.1f, opacity> 0.95f) << opacity;
  }
}

}  // namespace
}  // namespace splatlas
