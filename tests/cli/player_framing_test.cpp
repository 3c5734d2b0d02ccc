// Framing of pictures: --fit, --center and --zoom.

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

constexpr int kSide = 100;  // of the pictures, in pixels

/// Columns and rows of a picture that show something.
struct Shown {
  double left = kSide, right = 0, top = kSide, bottom = 0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
  [[nodiscard]] double middle_x() const { return 0.5 * (left + right); }
  [[nodiscard]] double middle_y() const { return 0.5 * (top + bottom); }
};

class PlayerFraming : public testing::Test {
 protected:
  [[nodiscard]] ProgramResult run(const Words& options) const {
    return run_player(joined({"render", phantom_atlas(), "-o", "x.exr", "--size", "100x100"}, options),
                      folder_.path());
  }
  /// Renders, and returns the bytes of the picture.
  [[nodiscard]] std::string picture(const Words& options) const {
    const ProgramResult result = run(options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, testing::AnyOf(IsEmpty(), testing::HasSubstr("the selection is empty")));
    return read_bytes(folder_.file("x.exr"));
  }
  [[nodiscard]] Shown shown(const Words& options) const {
    (void)picture(options);
    const std::vector<float> pixels = read_pixels(folder_.file("x.exr"));
    EXPECT_EQ(pixels.size(), std::size_t{4} * kSide * kSide);
    Shown shown;
    for (std::size_t n = 0; n < pixels.size() / 4; ++n) {
      if (pixels[4 * n + 3] < 1.0f / 255) continue;
      const auto x = static_cast<double>(n % kSide), y = static_cast<double>(n / kSide);
      shown = {std::min(shown.left, x), std::max(shown.right, x + 1), std::min(shown.top, y),
               std::max(shown.bottom, y + 1)};
    }
    return shown;
  }

  TemporaryFolder folder_;
};

const Words kBall{"--background", "transparent", "--select", "\"Sphere 2\":surface"};

/// A ball from any side, in both projections: margins of 2 % on each side. Edge pixels are covered in part.
TEST_F(PlayerFraming, FitsTheSelectionByDefault) {
  for (const std::string projection : {"parallel", "perspective"}) {
    for (const std::string azimuth : {"0", "37", "90"}) {
      const Words view = joined(kBall, {"--projection", projection, "--azimuth", azimuth});
      const Shown ball = shown(view);
      EXPECT_GE(std::max(ball.width(), ball.height()), 94) << projection << azimuth;
      EXPECT_LE(std::max(ball.width(), ball.height()), 98);
      EXPECT_NEAR(ball.middle_x(), 50, 1);
      EXPECT_NEAR(ball.middle_y(), 50, 1);
      EXPECT_TRUE(picture(view) == picture(joined(view, {"--fit", "selection"})));
    }
  }
}

/// The grid's frame does not depend on the selection.
TEST_F(PlayerFraming, FitsTheGridOnRequest) {
  const Shown both = shown({"--background", "transparent", "--select", "*:surface", "--fit", "grid"});
  const Shown ball = shown(joined(kBall, {"--fit", "grid"}));
  EXPECT_LT(ball.width(), 40);
  EXPECT_GE(ball.left, both.left);
  EXPECT_LE(ball.right, both.right);
  EXPECT_TRUE(picture({"--select", "", "--fit", "grid"}) == picture({"--select", ""}));
}

TEST_F(PlayerFraming, CentersAStructureOrAPoint) {
  const Words small = joined(kBall, {"--zoom", "0.2"});
  const auto center = phantom::kBalls[1].center;
  const std::string point =
      std::to_string(center[0]) + "," + std::to_string(center[1]) + ".0," + std::to_string(center[2]) + "e0";
  const std::string here = picture(joined(small, {"--center", "Sphere 2"}));
  for (const std::string& text : {point, std::string("sphere_2"), std::string("\"Sphere 2\""),
                                  std::string("Phantom/Sphere 2"), std::string("#2"), std::string("*2")}) {
    EXPECT_TRUE(here == picture(joined(small, {"--center", text}))) << text;
  }
  // The zoom stays: the ball moves, and keeps its size
  const Shown moved = shown(joined(small, {"--center", "Sphere 1", "--view", "anterior"}));
  const Shown still = shown(joined(small, {"--view", "anterior"}));
  EXPECT_NEAR(moved.width(), still.width(), 1);
  const double pixels_per_mm = 0.2 * 96 / (2 * phantom::kBalls[1].radius + 1);
  const double expected = pixels_per_mm * static_cast<double>(center[0] - phantom::kBalls[0].center[0]);
  EXPECT_NEAR(moved.middle_x() - still.middle_x(), expected, 2);
}

TEST_F(PlayerFraming, AGroupWithoutVoxelsHasNoCentre) {
  std::ofstream(folder_.file("groups.tree")) << "Empty/\nBalls/Sphere 1\n";
  const std::string source = phantom_folder().path().string();
  const ProgramResult built =
      run_preprocess({"build", "-o", "g.atlas", "--labels", source + "/labels.nrrd", "--names",
                      source + "/names.txt", "--tree", "groups.tree", "--progress", "none"},
                     folder_.path());
  ASSERT_EQ(built.status, 0) << built.err;
  const auto render = [&](const std::string& center) {
    return run_player({"render", "g.atlas", "-o", "x.png", "--size", "8x8", "--center", center},
                      folder_.path());
  };
  EXPECT_EQ(render("Balls").status, 0);
  std::filesystem::remove(folder_.file("x.png"));
  const ProgramResult refused = render("Empty");
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(refused.err,
            "splatlas-player: g.atlas: --center: \"Empty\" has no voxels; name another structure\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.file("x.png")));
}

}  // namespace
}  // namespace splatlas
