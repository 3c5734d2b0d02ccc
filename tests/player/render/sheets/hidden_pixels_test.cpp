#include "player/render/sheets/hidden_pixels.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "player/render/view/view_frame.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{90, 70};

/// Opaque in columns and rows from 20 to 59, but for one pixel.
FaceLayer square() {
  FaceLayer faces{.size = kSize,
                  .front = std::vector<Face>(static_cast<std::size_t>(kSize.width) * kSize.height)};
  for (int row = 20; row < 60; ++row) {
    for (int column = 20; column < 60; ++column)
      faces.front[static_cast<std::size_t>(row * kSize.width + column)].rgba = {0, 0, 0, 1};
  }
  faces.front[30 * kSize.width + 25].rgba[3] = 0.99f;
  return faces;
}

/// No picture pixel without an opaque face may sample a hidden sheet pixel, and most behind the square are
/// hidden.
TEST(HiddenPixels, AreSampledBehindFacesAlone) {
  const FaceLayer faces = square();
  for (const double turn : {0.0, 0.3, 2.5}) {
    Shear shear;
    const double c = 0.7 * std::cos(turn), s = 0.7 * std::sin(turn);  // 0.7 voxels per pixel
    shear.picture_to_sheet = {c, -s, 40, s, c, 30};
    SheetWindow window;
    window.scale = 2;
    window.u0 = window.v0 = -80;
    window.columns = window.rows = 240;
    std::vector<float> floats;
    BandImage image(window, 1, 0, window.rows, floats);
    HiddenPixels(faces).close(shear, window, image);
    const auto is_hidden = [&](std::int64_t column, std::int64_t row) {
      const float opacity =
          image.row(row, column % window.scale)[image.plane_stride() + column / window.scale];
      EXPECT_TRUE(opacity == 0 || opacity == 1);
      return opacity == 1;
    };
    const Affine2 map = picture_to_pixels(shear, window);
    int behind = 0, hidden = 0;
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const bool is_open = !faces.hides(static_cast<std::size_t>(y * kSize.width + x));
        for (const auto& [dx, dy] :
             {std::pair{0.5, 0.5}, {0.01, 0.01}, {0.99, 0.01}, {0.01, 0.99}, {0.99, 0.99}}) {
          const auto u =
              static_cast<std::int64_t>(std::floor(map.xx * (x + dx) + map.xy * (y + dy) + map.x0));
          const auto v =
              static_cast<std::int64_t>(std::floor(map.yx * (x + dx) + map.yy * (y + dy) + map.y0));
          for (std::int64_t row = v - 1; is_open && row <= v + 2; ++row) {
            for (std::int64_t column = u - 1; column <= u + 2; ++column) ASSERT_FALSE(is_hidden(column, row));
          }
          behind += is_open ? 0 : 1;
          hidden += !is_open && is_hidden(u, v) ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(behind, 5 * (40 * 40 - 1));
    EXPECT_GT(hidden, behind * 6 / 10) << turn;
  }
}

}  // namespace
}  // namespace splatlas
