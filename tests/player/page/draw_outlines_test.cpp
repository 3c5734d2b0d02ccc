#include <algorithm>
#include <array>
#include <vector>

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
  void draw() { draw_outlines(ids, depths, 1, picture); }
  [[nodiscard]] std::array<float, 4> at(int x) const { return picture.at(x, 6); }
};

TEST(DrawOutlines, DarkensTheBorderOfStructures) {
  Halves halves(2, 5);
  halves.draw();
  for (const auto& [x, value] : {std::pair(7, 1.0f), {8, 0.625f}, {9, 0.25f}, {10, 0.625f}, {11, 1.0f}}) {
    EXPECT_FLOAT_EQ(halves.at(x)[0], value) << x;
    EXPECT_FLOAT_EQ(halves.at(x)[3], 1) << x;
  }
}

TEST(DrawOutlines, DarkensFoldsButNoSlopes) {
  Halves fold(1, 18), slope(1, 16);
  fold.draw();
  slope.draw();
  EXPECT_FLOAT_EQ(fold.at(9)[1], 0.25f);
  EXPECT_FLOAT_EQ(slope.at(9)[1], 1);
}

TEST(DrawOutlines, ReachIntoTheBackground) {
  Halves halves(0, DepthMap::kBackground);
  halves.draw();
  EXPECT_FLOAT_EQ(halves.at(9)[0], 0.25f);
  EXPECT_FLOAT_EQ(halves.at(10)[0], 0);
  EXPECT_FLOAT_EQ(halves.at(10)[3], 0.375f);
  EXPECT_FLOAT_EQ(halves.at(11)[3], 0);
}

TEST(DrawOutlines, LeaveTranslucentStructuresAlone) {
  for (const float opacity : {0.9f, 0.96f}) {
    Halves halves(2, 5);
    for (float& value : halves.picture.rgba) value *= opacity;
    halves.draw();
    EXPECT_EQ(halves.at(9)[0]<opacity / 2, opacity> 0.95f) << opacity;
  }
}

TEST(DrawOutlines, WidenWithThePicture) {
  const PictureSize size{1800, 1800};
  const std::size_t pixels = std::size_t{1800} * 1800;
  Picture picture{size, std::vector<float>(4 * pixels, 1.0f)};
  IdImage ids{size, std::vector<StructureNumber>(pixels, 1)};
  for (std::size_t n = 0; n < pixels / 2; ++n) ids.numbers[n] = 2;  // the upper half
  draw_outlines(ids, {size, std::vector<float>(pixels, 5.0f)}, 1, picture);
  for (const auto& [y, value] :
       {std::pair(897, 1.0f), {898, 0.625f}, {899, 0.25f}, {900, 0.25f}, {901, 0.625f}, {902, 1.0f}})
    EXPECT_FLOAT_EQ(picture.at(900, y)[0], value) << y;
}

}  // namespace
}  // namespace splatlas
