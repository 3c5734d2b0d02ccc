#include "player/window/session/view_names.h"

#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "player/camera_moves.h"

namespace splatlas {
namespace {

const Display kDisplay{.window_low = 0, .window_high = 1, .center_lps_mm = {10, -20, 30}, .radius_mm = 80};
constexpr PictureSize kSize{640, 480};

TEST(ViewNames, EdgesOfTheNamedViews) {
  // Anatomical convention: right and up vectors of each view.
  const std::array<std::pair<NamedView, std::string>, 6> edges{{{NamedView::kAnterior, "LS"},
                                                                {NamedView::kPosterior, "RS"},
                                                                {NamedView::kLeft, "PS"},
                                                                {NamedView::kRight, "AS"},
                                                                {NamedView::kSuperior, "RA"},
                                                                {NamedView::kInferior, "LA"}}};
  for (const auto& [named, letters] : edges) {
    const auto view = *parallel_view(Camera::of(named), kSize, kDisplay);
    EXPECT_EQ(direction_letters(view.right_lps) + direction_letters(view.up_lps), letters) << title_of(named);
  }
}

TEST(ViewNames, KnowsTheNamedViews) {
  for (const NamedView named : {NamedView::kAnterior, NamedView::kPosterior, NamedView::kLeft,
                                NamedView::kRight, NamedView::kSuperior, NamedView::kInferior}) {
    Camera camera = Camera::of(named);
    camera.zoom = 3;
    EXPECT_EQ(view_of(camera), named);
    EXPECT_EQ(view_of(turned(camera, 360, 0)), named);
    EXPECT_EQ(view_of(turned(camera, 1, 0)), std::nullopt);
  }
}

}  // namespace
}  // namespace splatlas
