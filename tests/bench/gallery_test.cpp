#include "bench/gallery.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/paper_tables.h"
#include "format/selection.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;

class Gallery : public ::testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path_, std::ios::binary) << text; }

  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "gallery.tsv";
};

TEST_F(Gallery, GivesTheFiguresOfOneAtlas) {
  write(
      "# a comment\n"
      "1a\tball\t--azimuth 30 --elevation -20\tBall:surface + \"A b\":volume\n"
      "2a\tcube\t--zoom 2\tCube\n"
      "1b\tball\t--cut left=0 --cap none\tBall\n");
  const auto figures = read_gallery(path_, "ball");
  ASSERT_TRUE(figures) << figures.error().message;
  ASSERT_EQ(figures->size(), 2u);
  EXPECT_EQ((*figures)[0].name, "1a");
  EXPECT_EQ((*figures)[0].camera.azimuth_deg, 30);
  EXPECT_EQ((*figures)[0].camera.elevation_deg, -20);
  EXPECT_EQ((*figures)[0].selection, "Ball:surface + \"A b\":volume");
  EXPECT_EQ((*figures)[1].name, "1b");
  EXPECT_EQ((*figures)[1].camera.zoom, 1);
}

TEST_F(Gallery, TellsWhichLineIsWrong) {
  for (const char* wrong : {"1a\tball\tBall:surface", "1a\tball\t--azimuth\tBall", "1a\tball\t--cut\tBall",
                            "1a\tball\t--from 3\tBall"}) {
    write(std::string("# a comment\n\n") + wrong + "\n");
    const auto figures = read_gallery(path_, "ball");
    ASSERT_FALSE(figures) << wrong;
    EXPECT_THAT(figures.error().message, HasSubstr("line 3"));
  }
}

TEST_F(Gallery, TellsWhenThereIsNothingToMeasure) {
  write("1a\tball\t\tBall\n");
  EXPECT_THAT(read_gallery(path_, "cube").error().message, HasSubstr("no figure of cube"));
  EXPECT_THAT(read_gallery(path_ / "missing", "cube").error().message, HasSubstr("missing"));
}

TEST(GalleryOfTheSources, HasEveryFigureThatThePapersTablesMeasure) {
  const auto expect_figures = [](const char* atlas, std::span<const paper::Traversal> rows) {
    const auto figures = read_gallery(atlas);
    ASSERT_TRUE(figures) << figures.error().message;
    for (const paper::Traversal& row : rows) {
      const auto found = std::find_if(figures->begin(), figures->end(),
                                      [&](const Figure& figure) { return figure.name == row.figure; });
      ASSERT_NE(found, figures->end()) << row.figure;
      EXPECT_TRUE(parse_selection(found->selection)) << found->selection;
    }
  };
  expect_figures("phantom", paper::kTable2);
  expect_figures("colin27", paper::kTable4);
}

}  // namespace
}  // namespace splatlas
