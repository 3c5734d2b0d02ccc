#include <gtest/gtest.h>

#include "player/render/surfaces/tile_layers.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{5, 4};

SurfacesSeen seen(std::uint32_t side, float share, float grey, float depth) {
  SurfacesSeen pixel;
  pixel.add(side, 1, {depth, {grey * share, grey * share, grey * share, share}, 0});
  return pixel;
}

std::vector<std::uint8_t> edges_of(const std::vector<SurfacesSeen>& pixels, float pixel_voxels = 1) {
  ThreadPool pool(2);
  std::vector<std::uint8_t> edges;
  const auto row = [&](std::int32_t y, std::vector<SurfacesSeen>&) { return &pixels[kSize.pixel(0, y)]; };
  find_edge_pixels(row, kSize, pixel_voxels, edges, pool);
  return edges;
}

TEST(EdgePixels, AreOnBothSidesOfABorderAndNowhereElse) {
  std::vector<SurfacesSeen> pixels(20);
  pixels[2 * 5 + 3] = seen(4, 0.5f, 1, 7);
  const std::vector<std::uint8_t> expected{0, 0, 0, 0, 0,  //
                                           0, 0, 0, 1, 0,  //
                                           0, 0, 1, 1, 1,  //
                                           0, 0, 0, 1, 0};
  EXPECT_EQ(edges_of(pixels), expected);
}

TEST(EdgePixels, AreNotWhereLightAloneChanges) {
  std::vector<SurfacesSeen> pixels(20, seen(4, 1, 0.9f, 7));
  pixels[7] = seen(4, 1, 0.1f, 8);
  EXPECT_EQ(edges_of(pixels), std::vector<std::uint8_t>(20, 0));
}

TEST(EdgePixels, AreNotWhereAnotherSurfaceHasTheSameAppearance) {
  std::vector<SurfacesSeen> pixels(20, seen(4, 1, 0.5f, 7));
  pixels[7] = seen(9, 1, 0.5f + 0.9f * kEdgeContrast, 7);
  EXPECT_EQ(edges_of(pixels), std::vector<std::uint8_t>(20, 0));
  pixels[7] = seen(9, 1, 0.5f + 1.1f * kEdgeContrast, 7);
  EXPECT_EQ(edges_of(pixels)[7], 1);
}

TEST(EdgePixels, AreWhereASurfaceHidesAPartOfItselfFarBehind) {
  std::vector<SurfacesSeen> pixels(20, seen(4, 1, 0.9f, 7));
  pixels[7] = seen(4, 1, 0.1f, 7 + 1.1f * kEdgeSlope);
  EXPECT_EQ(edges_of(pixels)[7], 1);
  EXPECT_EQ(edges_of(pixels, 1.2f)[7], 0);  // larger pixels make it a slope
}

TEST(EdgePixels, TellTheOrderOfLayers) {
  SurfacesSeen first, second;
  first.add(1, 1, {3, {0.5f, 0, 0, 0.5f}, 0});
  first.add(2, 0.5f, {4, {0, 0.5f, 0, 0.5f}, 1});
  second.add(2, 1, {3, {0, 0.5f, 0, 0.5f}, 1});
  second.add(1, 0.5f, {4, {0.5f, 0, 0, 0.5f}, 0});
  std::vector<SurfacesSeen> pixels(20, first);
  pixels[0] = second;
  EXPECT_EQ(edges_of(pixels)[0], 1);
}

}  // namespace
}  // namespace splatlas
