// Strokes in pixels, vector documents and fonts.
#include "player/files/draw_annotations.h"

#include <cstring>
#include <fstream>

#include <gmock/gmock.h>

#include "player/files/svg_document.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using testing::HasSubstr;

Picture grey_picture(PictureSize size, float alpha) {
  Picture picture{size, std::vector<float>(4 * static_cast<std::size_t>(size.width) *
                                           static_cast<std::size_t>(size.height))};
  for (std::size_t n = 0; n < picture.rgba.size(); ++n) {
    picture.rgba[n] = n % 4 == 3 ? alpha : alpha * 0.1f * static_cast<float>(n % 7);
  }
  return picture;
}

TEST(DrawAnnotations, KeepsTheBitsOfOtherPixels) {
  const Picture before = grey_picture({40, 30}, 0.7f);
  Picture after = before;
  AnnotationLayer layer;
  layer.boxes.push_back({{2, 2, 6, 5}, Rgb{255, 0, 0}});
  layer.lines.push_back({{10, 10}, {30, 10}, 2, 4, Rgb{0, 0, 0}, Rgb{255, 255, 255}});
  layer.dots.push_back({{30, 20}, 3, 1, Rgb{0, 0, 0}, Rgb{255, 255, 255}});
  ASSERT_TRUE(draw_annotations(after, layer, Rgb{255, 255, 255}, TextDrawer({})));
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool box = x >= 2 && x < 6 && y >= 2 && y < 5;
      const bool line = x >= 10 && x < 30 && y >= 8 && y < 12;
      const bool dot = x >= 25 && x < 35 && y >= 15 && y < 25;
      if (box || line || dot) continue;
      const auto a = before.at(x, y), b = after.at(x, y);
      EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(a)), 0) << x << ", " << y;
    }
  }
  EXPECT_FLOAT_EQ(after.at(3, 3)[0], 1);
  EXPECT_FLOAT_EQ(after.at(3, 3)[1], 0);
  EXPECT_FLOAT_EQ(after.at(20, 10)[0], 0);  // the stroke is opaque
  EXPECT_FLOAT_EQ(after.at(30, 20)[3], 1);
}

TEST(DrawAnnotations, KeepsTransparencyWithoutABackground) {
  Picture picture{{4, 4}, std::vector<float>(64)};
  AnnotationLayer layer;
  layer.boxes.push_back({{0, 0, 1.5, 1}, Rgb{255, 255, 255}});
  ASSERT_TRUE(draw_annotations(picture, layer, std::nullopt, TextDrawer({})));
  EXPECT_FLOAT_EQ(picture.at(0, 0)[3], 1);
  EXPECT_FLOAT_EQ(picture.at(1, 0)[3], 0.5f);
  EXPECT_FLOAT_EQ(picture.at(1, 0)[0], 0.5f);  // premultiplied white
  EXPECT_EQ(picture.at(2, 0)[3], 0);
}

TEST(DrawAnnotations, CoversTheAreaOfAStroke) {
  const PlacedLine slanted{{10, 12}, {50, 31}, 3, 0, {}, {}};
  double sum = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) sum += stroke_coverage(slanted, 3, x, y);
  }
  EXPECT_NEAR(sum, 3 * std::hypot(40, 19), 0.02 * sum);  // box filters along and across the stroke
}

TEST(SvgDocument, KeepsTextAsText) {
  AnnotationLayer layer;
  layer.texts.push_back({"Gyrus <\xc3\xa4> & \"\xce\xb1\"", 10, 20, 50, 12, FontStyle::kBold, Rgb{1, 2, 3}});
  layer.lines.push_back({{1, 2}, {3, 4}, 1, 2, Rgb{0, 0, 0}, Rgb{255, 255, 255}});
  const std::vector<std::byte> png{std::byte{0x4d}, std::byte{0x61}};
  const std::string svg = svg_document(png, {2480, 3508}, 300, layer);
  EXPECT_THAT(svg, HasSubstr("width=\"209.973mm\" height=\"297.011mm\" viewBox=\"0 0 2480 3508\""));
  EXPECT_THAT(svg, HasSubstr("base64,TWE=\""));
  EXPECT_THAT(svg, HasSubstr(">Gyrus &lt;\xc3\xa4&gt; &amp; &quot;\xce\xb1&quot;</text>"));
  EXPECT_THAT(svg, HasSubstr("font-weight=\"bold\""));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#ffffff\" stroke-width=\"2.00\" stroke-opacity=\"0.7\""));
}

TEST(FindFonts, PrefersLiberationAndNamesThePackages) {
  const TemporaryFolder root;
  EXPECT_THAT(find_fonts({}, root.path()),
              FailsWith(ErrorCode::kFailed, HasSubstr("fonts-liberation or fonts-dejavu-core")));
  std::filesystem::create_directories(root.path() / "dejavu");
  std::ofstream(root.path() / "dejavu/DejaVuSans.ttf");
  const auto dejavu = find_fonts({}, root.path());
  ASSERT_TRUE(dejavu);
  EXPECT_EQ((*dejavu)[1], root.path() / "dejavu/DejaVuSans.ttf");  // bold is missing
  std::filesystem::create_directories(root.path() / "liberation");
  std::ofstream(root.path() / "liberation/LiberationSans-Regular.ttf");
  EXPECT_EQ(find_fonts({}, root.path())->front(), root.path() / "liberation/LiberationSans-Regular.ttf");
  EXPECT_THAT(find_fonts("no.ttf", root.path()), FailsWith(ErrorCode::kFailed, HasSubstr("no.ttf: ")));
}

}  // namespace
}  // namespace splatlas
