// Strokes and text in pixels, and vector documents.
#include "player/files/draw_annotations.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

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
  ASSERT_TRUE(draw_annotations(after, layer, Rgb{255, 255, 255}, nullptr));
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool box = x >= 2 && x < 6 && y >= 2 && y < 5;
      const bool line = x >= 10 && x < 30 && y >= 8 && y < 12;
      const bool dot = x >= 25 && x < 35 && y >= 15 && y < 25;
      if (box || line || dot) continue;
      EXPECT_EQ(before.at(x, y), after.at(x, y)) << x << ", " << y;
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
  ASSERT_TRUE(draw_annotations(picture, layer, std::nullopt, nullptr));
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

TEST(SvgDocument, AnchorsTextFromRightToLeftAtItsRightEnd) {
  AnnotationLayer layer;
  layer.texts.push_back(
      {"\xd7\xa1\xd7\x95\xd7\xa3 (abc)", 10, 20, 50, 12, FontStyle::kRegular, Rgb{0, 0, 0}});
  layer.texts.push_back({"1 abc \xd7\xa1", 10, 40, 50, 12, FontStyle::kRegular, Rgb{0, 0, 0}});
  const std::string svg = svg_document({}, {100, 100}, 300, layer);
  EXPECT_THAT(svg, HasSubstr("<text x=\"60.00\" y=\"20.00\""));
  EXPECT_THAT(svg, HasSubstr("direction=\"rtl\">\xd7\xa1"));
  EXPECT_THAT(svg, HasSubstr("<text x=\"10.00\" y=\"40.00\""));
}

/// Ink of a text as its columns: whether each has any.
std::vector<bool> columns_of(const TextCoverage& text) {
  std::vector<bool> columns(static_cast<std::size_t>(text.width));
  for (std::size_t n = 0; n < text.coverage.size(); ++n)
    columns[n % columns.size()] = columns[n % columns.size()] || text.coverage[n] > 0.1f;
  return columns;
}

struct DrawText : testing::Test {
  TextDrawer drawer{std::filesystem::path()};
  void SetUp() override { value_or_throw(drawer.wait()); }
  [[nodiscard]] TextCoverage drawn(const std::string& text, double x, double size) const {
    const auto coverage = drawer->draw({text, x, 30, 0, size, FontStyle::kRegular, {}});
    EXPECT_TRUE(coverage);
    return coverage.value_or(TextCoverage{});
  }
};

/// The library that was used before drew each byte outside ASCII as a letter.
TEST_F(DrawText, ShapesEveryScript) {
  const double latin = drawer->width("Groesse", 20, FontStyle::kRegular);
  EXPECT_LT(drawer->width("Gr\xc3\xb6\xc3\x9f"
                          "e",
                          20, FontStyle::kRegular),
            latin);
  EXPECT_NEAR(drawer->width("e\xcc\x81", 20, FontStyle::kRegular),
              drawer->width("e", 20, FontStyle::kRegular), 0.1)
      << "a combining accent";
  EXPECT_FALSE(drawer->lacks_glyphs(
      "Gr\xc3\xb6\xc3\x9f"
      "e\n\xd0\x9b\xd0\xb5\xd0\xb2\xd0\xbe\xd0\xb5 \xd7\xa1\xd7\x95\xd7\xa3 \xd9\x85\xd8\xae"));
  EXPECT_TRUE(drawer->lacks_glyphs("\xf4\x80\x80\x80")) << "private use";
  // Arabic letters join: less wide than apart
  EXPECT_LT(drawer->width("\xd9\x85\xd8\xae", 20, FontStyle::kRegular),
            drawer->width("\xd9\x85 \xd8\xae", 20, FontStyle::kRegular) -
                drawer->width(" ", 20, FontStyle::kRegular) - 1);
}

TEST_F(DrawText, IsAsWideAsMeasuredAtAnySizeAndPlace) {
  for (const double size : {9.0, 12.5, 40.0}) {
    const double width = drawer->width("HillH", size, FontStyle::kRegular);
    EXPECT_NEAR(width, size * drawer->width("HillH", 1000, FontStyle::kRegular) / 1000, 0.02);
    for (const double x : {10.0, 10.25, 10.5}) {
      const TextCoverage text = drawn("HillH", x, size);
      const std::vector<bool> columns = columns_of(text);
      const auto first = std::ranges::find(columns, true) - columns.begin();
      const auto last = std::find(columns.rbegin(), columns.rend(), true) - columns.rbegin();
      EXPECT_GE(text.left + first, x);
      EXPECT_LE(text.left + text.width - last, x + width + 0.5);
      EXPECT_GT(static_cast<double>(text.width - first - last), 0.85 * width);
    }
  }
  const TextCoverage left = drawn("l", 10, 20), right = drawn("l", 10.5, 20);
  EXPECT_NE(left.coverage, right.coverage) << "glyphs are not moved to whole pixels";
}

/// A font of absurdly large glyphs took a minute, and damaged ones crashed.
TEST_F(DrawText, RefusesDamagedFonts) {
  const std::string liberation = "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf";
  std::string font = read_bytes(liberation);
  ASSERT_GT(font.size(), 1000u);
  const TemporaryFolder folder;
  int files = 0;
  const auto opened = [&](const std::string& bytes) {
    const std::filesystem::path file = folder.path() / fmt::format("{}.ttf", ++files);
    std::ofstream(file, std::ios::binary) << bytes;
    return TextDrawer(file).wait();
  };
  EXPECT_TRUE(opened(font));
  EXPECT_THAT(opened(font.substr(0, 200)),
              FailsWith(ErrorCode::kFailed, HasSubstr("cannot be read as a font")));
  EXPECT_THAT(opened("no font"), FailsWith(ErrorCode::kFailed, HasSubstr(".ttf: cannot be read as a font")));
  const std::size_t entry = font.find("head");
  ASSERT_LT(entry, 300u);
  std::size_t head = 0;
  for (std::size_t n = 0; n < 4; ++n) head = head << 8 | static_cast<unsigned char>(font[entry + 8 + n]);
  font[head + 18] = 0, font[head + 19] = 16;  // units per em
  EXPECT_THAT(opened(font), FailsWith(ErrorCode::kFailed, HasSubstr("is damaged")));
}

}  // namespace
}  // namespace splatlas
